// Starts the page's own program in a worker, a module. The page names the program's script, and sends the program as it has
// compiled it. What goes wrong here reaches the page as an error event, which a rejected promise would not.
const script = import("./" + new URL(location.href).searchParams.get("program"));

onmessage = async ({ data }) => {
  onmessage = null;
  try {
    const { default: start } = await script;
    await start({ module_or_path: data });
  } catch (error) {
    setTimeout(() => { throw error; });
  }
};
