// The page: what comes live goes to its parts.

import * as channel from "./channel.js";
import * as control from "./control.js";
import * as editor from "./editor.js";
import * as fleet from "./fleet.js";
import * as live from "./live.js";
import * as mosaic from "./mosaic.js";
import { element, say } from "./words.js";

const connection = document.getElementById("connection");
const warnings = document.getElementById("warnings");

function take(head, body) {
  if (head.kind === "frame") mosaic.show(head, body);
  else if (head.kind === "history") channel.remember(head.points);
  else tell(head);
}

function tell(status) {
  const many = status.robots.length;
  const through = status.by ? `, seen through ${status.by}` : "";
  state(!status.away, status.away || `live: ${many} robot${many === 1 ? "" : "s"}${through}`);
  const wrong = [status.problem ? `specs are not understood here: ${status.problem}` : "", ...status.warnings].filter(Boolean);
  if (warnings.dataset.said !== wrong.join("\n")) {
    warnings.dataset.said = wrong.join("\n");
    warnings.replaceChildren(...wrong.map((text) => element("li", text)));
    warnings.hidden = !wrong.length;
  }
  mosaic.know(status.streams);
  channel.tell(status);
  fleet.tell(status.robots);
  control.tell(status);
  editor.follow(status.specs);
}

function state(good, text) {
  connection.classList.toggle("bad", !good);
  say(connection, text);
}

live.follow(take, (good, text) => { if (!good) state(false, text); });
