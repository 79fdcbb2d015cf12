// The buttons: what changes robots, and a demo's world.

import { ask, token } from "./ask.js";
import { element, say } from "./words.js";

const outcome = document.getElementById("outcome");
const buttons = [...document.querySelectorAll("#filters button")];
const form = { channel: document.getElementById("demo-channel"), red: document.getElementById("demo-red") };
const field = Object.fromEntries(["capacity", "latency", "loss", "red-robot"].map((id) => [id, document.getElementById(id)]));
const BITS = 8e-6; // Mbit in a byte
let asked = false;

export function tell(status) {
  const modes = new Set(status.robots.filter((robot) => robot.takes_part).map((robot) => robot.mode));
  const mode = modes.size === 1 ? [...modes][0] : null;
  const filter = { pass: "off", shadow: "shadow", enforce: status.variant }[mode];
  for (const button of buttons) button.setAttribute("aria-pressed", String(button.dataset.filter === filter));
  world(status.demo ?? {});
}

function world(demo) {
  if (demo.channel && form.channel.hidden) {
    field.capacity.value = demo.channel.limit * BITS;
    field.latency.value = Math.round(1000 * demo.channel.latency);
    field.loss.value = Math.round(100 * demo.channel.loss);
    capacity();
  }
  const robots = demo.red?.robots ?? [];
  if (robots.join() !== [...field["red-robot"].options].map((option) => option.value).join()) {
    field["red-robot"].replaceChildren(...robots.map((name) => element("option", name)));
  }
  form.channel.hidden = !demo.channel;
  form.red.hidden = !robots.length;
}

function capacity() {
  const text = `${field.capacity.value} Mbit/s`;
  say(document.getElementById("capacity-shown"), text);
  field.capacity.setAttribute("aria-valuetext", text);
}

export function report(outcomes) {
  outcome.replaceChildren(...outcomes.map((each) => (
    element("p", `${each.robot}: ${each.said.join("; ")}`, { class: each.obeyed ? "good" : "bad" })
  )));
}

export function complain(text) {
  outcome.replaceChildren(element("p", text, { class: "bad" }));
}

async function order(path, told, said) {
  if (asked) return;
  asked = true;
  outcome.replaceChildren(element("p", "asking the robots …"));
  try {
    said(await ask(path, told));
  } catch (error) {
    complain(error.message);
  }
  asked = false;
}

function done(what) {
  return () => outcome.replaceChildren(element("p", what, { class: "good" }));
}

for (const button of buttons) {
  button.disabled = !token;
  button.addEventListener("click", () => order("filter", { filter: button.dataset.filter }, (answer) => report(answer.outcomes)));
}
for (const each of Object.values(form)) for (const part of each.querySelectorAll("button, input, select")) part.disabled = !token;
document.getElementById("no-token").hidden = Boolean(token);
field.capacity.addEventListener("input", capacity);
form.channel.addEventListener("submit", (event) => {
  event.preventDefault();
  const channel = { limit: field.capacity.value / BITS, latency: field.latency.value / 1000, loss: field.loss.value / 100 };
  order("demo/channel", channel, done(`the channel carries ${field.capacity.value} Mbit/s now`));
});
form.red.addEventListener("submit", (event) => {
  event.preventDefault();
  order("demo/red", { robot: field["red-robot"].value }, done(`something red is in the path of ${field["red-robot"].value}`));
});
