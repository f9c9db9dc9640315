"use strict";
// Data in the page, as packed.py writes them.

/** The bytes of a packed text. */
async function unpacked(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"))).arrayBuffer();
}

/** The data of a packed text that is JSON; `revive`: as JSON.parse has it. */
async function unpackedJson(text, revive) {
  return JSON.parse(new TextDecoder().decode(await unpacked(text)), revive);
}
