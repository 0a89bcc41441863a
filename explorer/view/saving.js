// The picture and the film of what the page shows, as files.

import { Film, SECONDS } from "./film.js";
import { record } from "./webm.js";

const $ = (id) => document.getElementById(id);
const TITLE = "The disk that nearly falls flat";

/** The picture of what is shown, or a moment on the way to it, or with `film` one of the film: a canvas. */
export function picture(store, width, height, share = 1, film = false) {
  const canvas = Object.assign(document.createElement("canvas"), { width, height });
  const made = new Film(store);
  if (film) made.drawFrame(canvas.getContext("2d"), width, height, share);
  else made.drawPicture(canvas.getContext("2d"), width, height, share);
  return canvas;
}

/** The film of what is shown, 1080 lines: a WebM file. */
export async function film(store) {
  const made = new Film(store);
  const [width, height] = [1920, 1080];
  const draw = (context, share) => made.drawFrame(context, width, height, share);
  const data = await record(draw, SECONDS, width, height, TITLE);
  return new Blob([data], { type: "video/webm" });
}

function save(address, name) {
  Object.assign(document.createElement("a"), { href: address, download: name }).click();
}

export function bindSaving(store) {
  $("save-picture").addEventListener("click", () => save(picture(store, 1920, 1080).toDataURL(), "nearflat.png"));
  $("save-film").addEventListener("click", async () => {
    const button = $("save-film"), before = button.textContent;
    button.disabled = true;
    button.textContent = "recording …";
    try {
      const address = URL.createObjectURL(await film(store));
      save(address, "nearflat.webm");
      setTimeout(() => URL.revokeObjectURL(address), 1000);
      button.textContent = before;
    } catch {
      button.textContent = "this browser cannot";
      setTimeout(() => { button.textContent = before; }, 3000);
    }
    button.disabled = false;
  });
}
