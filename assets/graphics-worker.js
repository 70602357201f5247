// Starts the program for the graphics processor in a worker. The files' names have no hash, so the page's version is in every address. What
// goes wrong here reaches the page as an error event, which a rejected promise would not.
"use strict";
(function () {
  var name = "./graphics", version = self.location.search;
  importScripts(name + ".js" + version);
  wasm_bindgen({ module_or_path: name + "_bg.wasm" + version }).catch(function (error) {
    setTimeout(function () { throw error; });
  });
})();
