// Keeps the page of one version in the browser, so that it opens at once, and without a network.
//
// The page registers this file with its version, the hash in the program's name. Names with a hash never change their
// content, so they are read from the cache first. The page itself comes from the network if it can. A cache holds the page
// and the files that it names, so that files of two versions are never mixed.
"use strict";

const version = new URL(location.href).searchParams.get("version");
const folder = registration.scope;
// Other folders of the same server may have pages of their own.
const prefix = `kalmanscope ${folder} `;
const name = prefix + version;

// The page is not waited for any longer than this if there is a kept one [ms].
const PATIENCE = 4000;

const HASHED = /[\w.-]*[0-9a-f]{12,16}[\w.-]*\.\w+/;

// A new version waits until all pages of the old one are closed: an open page still starts workers with its own program.
addEventListener("install", (event) => {
  event.waitUntil(keep());
});

addEventListener("activate", (event) => {
  event.waitUntil(forgetOthers());
});

addEventListener("fetch", (event) => {
  const { method, url } = event.request;
  if (method !== "GET" || !url.startsWith(folder)) return;
  const file = new URL(url).pathname.slice(new URL(folder).pathname.length);
  if (file === "" || file === "index.html") {
    event.respondWith(newest(event));
  } else if (HASHED.exec(file)?.[0] === file) {
    event.respondWith(kept(event.request));
  } else if (new URL(url).search.includes(version)) {
    event.respondWith(keptOnceLoaded(event.request));
  }
});

async function keep() {
  const page = await fetch(folder, { cache: "no-cache" });
  const html = await page.clone().text();
  if (!isOfThisVersion(page, html)) throw new Error("the server has another version by now");
  const files = new Set(html.match(new RegExp(`\\./${HASHED.source}`, "g")));
  const cache = await caches.open(name);
  // The browser has just loaded them.
  await cache.addAll([...files].map((file) => new Request(file, { cache: "force-cache" })));
  // The page's workers run the same program.
  const [, script] = html.match(/name="version" content="([^"]+)"/);
  await cache.add(`./worker.js?program=${script}`);
  await cache.put(folder, page);
}

function isOfThisVersion(page, html) {
  return page.ok && !page.redirected && html.includes(version);
}

async function forgetOthers() {
  const names = await caches.keys();
  await Promise.all(names.filter((other) => other.startsWith(prefix) && other !== name).map((other) => caches.delete(other)));
  await clients.claim();
}

async function kept(request) {
  const cache = await caches.open(name);
  return (await cache.match(request, { ignoreVary: true })) ?? fetch(request);
}

// Files of this version that not every reader needs, such as those for the graphics processor.
async function keptOnceLoaded(request) {
  const cache = await caches.open(name);
  const old = await cache.match(request, { ignoreVary: true });
  if (old) return old;
  const file = await fetch(request);
  if (file.ok) await cache.put(request, file.clone());
  return file;
}

// The page from the network, or the kept one where the network fails or is slow.
async function newest(event) {
  const cache = await caches.open(name);
  const old = await cache.match(folder);
  const fresh = fetch(event.request).then((page) => {
    if (page.ok) event.waitUntil(renew(cache, page.clone()));
    return page.status >= 500 && old ? old : page;
  });
  if (!old) return fresh;
  const late = new Promise((resolve) => setTimeout(resolve, PATIENCE, old));
  return Promise.race([fresh.catch(() => old), late]);
}

// The words of a page may change while its program stays.
async function renew(cache, page) {
  if (isOfThisVersion(page, await page.clone().text())) await cache.put(folder, page);
}
