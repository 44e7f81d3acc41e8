// SPDX-License-Identifier: Apache-2.0
// The card that shows whether the projectors are still aligned.
import { ago, byId, fixed, isNumber, make, makeSvg } from "./helpers.js";
import { ask, press, say } from "./requests.js";
import { tr } from "./texts.js";

const kLine = ["#d7b36a", "#7fb0c9", "#c98a7f", "#9cc07f", "#b39bd1", "#cfcfcf"];

// Plots the errors of the last ten minutes, the newest at the right, with a gap where nothing was measured.
function healingPlot(names, history) {
  const width = 600,
    height = 120,
    whole = 600;
  const largest = Math.max(1, ...history.flatMap((row) => row.slice(1).filter(isNumber)));
  // Errors are small and bumps are large, so the axis shows square roots.
  const x = (s) => width * (1 - Math.min(s, whole) / whole);
  const y = (px) => height - 4 - (height - 16) * Math.sqrt(Math.max(px, 0) / largest);
  const svg = makeSvg("svg", {
    viewBox: `0 0 ${width} ${height}`,
    role: "img",
    "aria-label": tr("Each projector's error in the last ten minutes: at most {px} pixels", { px: fixed(largest, 1) }),
  });
  for (const px of [0.2, 1, 5, 25, 125].filter((mark) => mark <= largest)) {
    svg.append(makeSvg("line", { x1: 0, x2: width, y1: y(px), y2: y(px), class: "mark" }));
    const label = makeSvg("text", { x: 2, y: y(px) - 2 });
    label.textContent = `${fixed(px, px < 1 ? 1 : 0)} px`;
    svg.append(label);
  }
  names.forEach((name, i) => {
    let points = [];
    const draw = () => {
      if (points.length > 1)
        svg.append(makeSvg("polyline", { points: points.join(" "), stroke: kLine[i % kLine.length] }));
      points = [];
    };
    for (const row of history) {
      if (isNumber(row[0]) && isNumber(row[i + 1])) points.push(`${x(row[0]).toFixed(1)},${y(row[i + 1]).toFixed(1)}`);
      else draw();
    }
    draw();
  });
  return svg;
}

function healingLine(projector, colour) {
  const item = make("li", undefined, projector.state === "good" ? "ok" : projector.wants_scan ? "fault" : "warning");
  const words = make("span");
  const name = make("b", projector.name);
  name.style.color = colour;
  const state = projector.state === "good" ? tr("in position") : projector.reason || projector.state;
  words.append(name, `: ${state}`);
  const figures = [];
  if (isNumber(projector.off_px) && projector.state === "good") figures.push(tr("error {px} px", { px: fixed(projector.off_px, 2) }));
  if (isNumber(projector.sigma_px)) figures.push(tr("uncertainty {px} px", { px: fixed(projector.sigma_px, 2) }));
  if (isNumber(projector.last_px))
    figures.push(tr("corrected by {px} px {ago}", { px: fixed(projector.last_px, 1), ago: ago(projector.last_s) }));
  words.append(make("span", figures.join(", "), "figures-line"));
  if (projector.wants_scan) words.append(make("span", tr("Start a calibration when the museum is closed."), "remedy"));
  item.append(words);
  return item;
}

export function showHealing(watched) {
  byId("healing-card").hidden = watched === null;
  if (watched === null) return;
  byId("healing-state").textContent = tr(
    "Fixed cameras compare the wall with the shown picture. A projector that was bumped is corrected without patterns.",
  );
  byId("healing-projectors").replaceChildren(
    ...watched.projectors.map((one, i) => healingLine(one, kLine[i % kLine.length])),
  );
  byId("healing-plot").replaceChildren(
    ...(watched.history.length > 1 ? [healingPlot(watched.names, watched.history)] : []),
  );
}

press("realign", async () => {
  await ask("/realign", {});
  say(tr("Every projector is measured anew; errors are corrected within some seconds."));
});

press("realign-undo", async () => {
  const answer = await ask("/realign/undo", {});
  say(tr("Undone: {what}.", { what: answer.undone }));
});
