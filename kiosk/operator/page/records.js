// SPDX-License-Identifier: Apache-2.0
// The cards of what was recorded: visitors, and the last faults.
import { byId, duration, make, makeSvg } from "./helpers.js";
import { dateText, dayText, ntr, tr } from "./texts.js";

const kBars = 30;

// One bar for each of the last days, the newest at the right.
function visitsPlot(days) {
  const largest = Math.max(1, ...days.map((day) => day.visits));
  const svg = makeSvg("svg", {
    viewBox: `0 0 ${10 * kBars} 60`,
    role: "img",
    "aria-label": tr("Visits on each of the last days: at most {n}", { n: largest }),
  });
  days.forEach((day, i) => {
    const height = (54 * day.visits) / largest;
    const bar = makeSvg("rect", { x: 10 * (kBars - 1 - i) + 1, y: 58 - height, width: 8, height, class: "bar" });
    const title = makeSvg("title", {});
    title.textContent = `${dayText(day.date)}: ${day.visits}`;
    bar.append(title);
    svg.append(bar);
  });
  return svg;
}

export function showVisits(visits) {
  byId("visits-card").hidden = visits === null;
  if (visits === null) return;
  const today = visits.days.find((day) => day.date === visits.today);
  const sentences = [
    today
      ? ntr("{n} visit today, {time} on average.", "{n} visits today, {time} on average.", today.visits, {
          time: duration(today.seconds / today.visits),
        })
      : tr("No visit today yet."),
    visits.is_visited && tr("Somebody is visiting now."),
  ];
  byId("visits-state").textContent = sentences.filter(Boolean).join(" ");
  byId("visits-plot").replaceChildren(...(visits.days.length > 0 ? [visitsPlot(visits.days)] : []));
}

export function showHistory(history, zone) {
  byId("history-card").hidden = history === null;
  if (history === null) return;
  byId("history-none").hidden = history.length > 0;
  byId("history").replaceChildren(
    ...history.map((event) => {
      const item = make("li", undefined, event.is_over ? "ok" : "fault");
      const words = make("span", event.is_over ? tr("{title}: over", event) : `${event.title}: ${event.sentence}`);
      words.append(make("span", dateText(event.at, zone, true), "figures-line"));
      item.append(words);
      return item;
    }),
  );
}
