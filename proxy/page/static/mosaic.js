// The pictures of all cameras, each with its rate and age.

import { element, rate, say, seconds } from "./words.js";

const OLD = 3; // [s] a picture that is older says so
const GONE = 600; // [s] so long the last picture stays of a robot that went away, for who looks for it
const mosaic = document.getElementById("mosaic");
const tiles = new Map();

export async function show(head, image) {
  const tile = tiles.get(head.key) ?? made(head.key);
  tile.rate = head.rate;
  tile.age = head.age;
  tile.since = performance.now();
  tile.waiting = new Blob([image], { type: head.type });
  if (tile.drawing) return; // the newest that came meanwhile is drawn next
  tile.drawing = true;
  while (tile.waiting) {
    const blob = tile.waiting;
    tile.waiting = null;
    try {
      const picture = await createImageBitmap(blob);
      if (tile.canvas.width !== picture.width) tile.canvas.width = picture.width;
      if (tile.canvas.height !== picture.height) tile.canvas.height = picture.height;
      tile.context.drawImage(picture, 0, 0);
      picture.close();
      tile.frames += 1;
      tile.figure.dataset.frames = tile.frames;
    } catch {
      tile.figure.dataset.broken = "a picture that cannot be shown";
    }
  }
  tile.drawing = false;
}

export function know(streams) {
  const told = new Map(streams.map((stream) => [stream.key, stream]));
  for (const [key, tile] of tiles) {
    const stream = told.get(key); // none of a robot that went away: what it shows is not known now
    const silent = (performance.now() - tile.since) / 1000;
    if (!stream && silent > GONE) remove(key, tile);
    if (stream) say(tile.name, stream.robot);
    if (stream) tile.rate = stream.rate;
    else if (silent > OLD) tile.rate = 0;
    tile.figure.classList.toggle("marked", Boolean(stream?.marked));
    tile.red.hidden = !stream?.marked;
  }
}

function tick() {
  const now = performance.now();
  for (const [key, tile] of tiles) {
    const age = tile.age + (now - tile.since) / 1000;
    tile.figure.classList.toggle("old", age > OLD);
    say(tile.ageShown, `${seconds(age)} old`);
    say(tile.rateShown, rate(tile.rate));
    const marked = tile.red.hidden ? "" : ", red now";
    tile.canvas.setAttribute("aria-label", `camera ${key}, ${seconds(age)} old${marked}`);
  }
}
setInterval(tick, 250);

function remove(key, tile) {
  tile.figure.remove();
  tiles.delete(key);
  document.getElementById("no-cameras").hidden = tiles.size > 0;
}

function made(key) {
  document.getElementById("no-cameras").hidden = true;
  const figure = element("figure", "", { "data-key": key });
  const canvas = element("canvas", "", { role: "img", "aria-label": `camera ${key}` });
  const caption = element("figcaption");
  const tile = {
    figure, canvas, context: canvas.getContext("2d"), frames: 0, drawing: false, waiting: null,
    name: element("b", key), red: element("span", "red", { class: "red" }),
    rateShown: element("span", "", { class: "rate" }), ageShown: element("span", "", { class: "age" }),
  };
  tile.red.hidden = true;
  caption.append(tile.name, tile.red, tile.rateShown, tile.ageShown);
  figure.append(canvas, caption);
  figure.title = key;
  const after = [...mosaic.children].find((other) => other.dataset.key.localeCompare(key, "en", { numeric: true }) > 0);
  mosaic.insertBefore(figure, after ?? null);
  tiles.set(key, tile);
  return tile;
}
