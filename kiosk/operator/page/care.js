// SPDX-License-Identifier: Apache-2.0
// The museum's cards: what needs attention, and what the museum's staff can do about it.
import { showHealing } from "./healing.js";
import { byId, fixed, get, isNumber, make, repeat } from "./helpers.js";
import { projectorNames } from "./page.js";
import { showHistory, showVisits } from "./records.js";
import { ask, press, pressTwice, say } from "./requests.js";
import { dateText, hoursText, ntr, tr } from "./texts.js";

// ---- Checks ----
// Screen readers say in words what the others see as colour and mark.
function levelWord(check) {
  return make("span", { fault: tr("Fault:"), warning: tr("Warning:"), ok: tr("Well:") }[check.level] + " ", "spoken");
}

function checkLine(check) {
  const item = make("li", undefined, check.level);
  const words = make("span");
  words.append(levelWord(check), `${check.title}: ${check.sentence}`);
  if (check.remedy) words.append(make("span", check.remedy, "remedy"));
  item.append(words);
  return item;
}

function showChecks(checks) {
  const rank = { fault: 0, warning: 1, ok: 2 };
  const wrong = checks.filter((check) => check.level !== "ok").sort((a, b) => rank[a.level] - rank[b.level]);
  byId("needs-section").hidden = wrong.length === 0;
  byId("needs").replaceChildren(
    ...wrong.map((check) => {
      const item = make("li", undefined, check.level);
      const title = make("h3");
      title.append(levelWord(check), check.title);
      item.append(title, make("p", check.sentence));
      if (check.remedy) item.append(make("p", check.remedy, "remedy"));
      return item;
    }),
  );
  byId("checks-summary").textContent = tr("All checks: {well} of {all} are well", {
    well: checks.length - wrong.length,
    all: checks.length,
  });
  byId("checks").replaceChildren(...checks.map(checkLine));
}

// ---- Calibration ----
let calibrationPicture = 0;

function showCalibration(calibration) {
  byId("calibration-card").hidden = calibration === null;
  if (calibration === null) return;
  const isRunning = calibration.state === "running";
  const isOfWall = calibration.what === "wall";
  const words = {
    idle: tr("A camera measures the wall so that the projectors make one picture. Keep the space before it free."),
    running: isOfWall ? `${Math.round(100 * calibration.fraction)} %: ${calibration.step}` : calibration.step,
    done: !isOfWall
      ? tr("The positions of the fixed cameras:")
      : isNumber(calibration.registration_p95_px)
        ? tr("Measured on {date}. Neighbouring pictures meet within {px} px in 95 % of places.", {
            date: calibration.date,
            px: fixed(calibration.registration_p95_px, 2),
          })
        : tr("Measured on {date}.", calibration),
    cancelled: !isOfWall
      ? tr("Cancelled; the previous positions of the fixed cameras stay in use.")
      : tr(
          "Cancelled; the previous calibration stays in use. The photographs are kept, so that the next one can resume.",
        ),
    failed: tr("It failed: {why}", { why: calibration.error }),
  };
  byId("calibration-state").textContent = words[calibration.state] || calibration.state;
  byId("calibration-progress").hidden = !isRunning;
  if (isOfWall) byId("calibration-progress").value = calibration.fraction;
  else byId("calibration-progress").removeAttribute("value");
  byId("calibration-remarks").replaceChildren(...calibration.remarks.map((remark) => make("li", remark)));
  byId("calibrate").hidden = isRunning;
  byId("calibrate-resume").hidden = !isOfWall || (calibration.state !== "cancelled" && calibration.state !== "failed");
  byId("calibration-question").hidden = calibration.question === "";
  byId("calibration-asked").textContent = calibration.question;
  byId("calibrate-restore").hidden = isRunning;
  byId("calibrate-cancel").hidden = !isRunning;
  showPieces(isRunning);
  const picture = byId("calibration-picture");
  picture.hidden = !isRunning || !calibration.has_picture;
  if (!picture.hidden) picture.src = `/calibration.jpg?${++calibrationPicture}`;
}

// Offers to correct one displaced projector alone.
function showPieces(isRunning) {
  const names = projectorNames();
  const select = byId("quick-projector");
  if (names.join("\n") !== [...select.options].map((option) => option.value).join("\n")) {
    select.replaceChildren(...names.map((name) => make("option", name)));
  }
  byId("quick-one").hidden = names.length === 0;
  byId("calibrate-parts").hidden = isRunning;
}

press("calibrate", () => ask("/calibration", { do: "start" }));
press("calibrate-resume", () => ask("/calibration", { do: "start", resume: true }));
press("calibrate-quick", () =>
  ask("/calibration", { do: "start", quick: true, projector: byId("quick-projector").value }),
);
press("place-cameras", () => ask("/calibration", { do: "place-cameras" }));
press("calibration-done", async () => {
  await ask("/calibration", { do: "answer", text: byId("calibration-answer").value });
  byId("calibration-answer").value = "";
});
byId("calibration-answer").addEventListener("keydown", (event) => {
  if (event.key === "Enter") byId("calibration-done").click();
});
press("calibrate-cancel", () => ask("/calibration", { do: "cancel" }));
pressTwice("calibrate-restore", tr("Really restore it?"), async () => {
  const answer = await ask("/calibration", { do: "restore" }, 35);
  say(tr("The calibration of {date} is in use again.", answer));
});

// ---- Settings, hours, software ----
function showSettings(provisioning) {
  const words = {
    installed: tr("The settings of the last USB stick are in use."),
    unchanged: tr("The last USB stick had the settings that were already in use."),
    restored: tr("The previous settings are in use again."),
    refused: tr("The last USB stick was refused."),
    unconfirmed: tr("A USB stick was plugged in that is not signed by the museum's owner."),
  };
  byId("settings-state").textContent =
    provisioning === null
      ? tr("No USB stick has been plugged in yet.")
      : [
          words[provisioning.verdict],
          provisioning.museum ? tr("Museum “{name}”.", { name: provisioning.museum }) : "",
          ntr("{n} projector.", "{n} projectors.", provisioning.projectors),
        ]
          .filter((sentence) => sentence !== "")
          .join(" ");
  const sentences = provisioning === null ? [] : [...provisioning.problems, ...provisioning.remarks];
  byId("settings-remarks").replaceChildren(...sentences.map((sentence) => make("li", sentence)));
  const isWaiting = provisioning !== null && provisioning.verdict === "unconfirmed";
  byId("settings-buttons").hidden = !isWaiting;
  byId("confirm-stick").dataset.digest = isWaiting ? provisioning.digest : "";
}
pressTwice("confirm-stick", tr("Really take the settings of this stick?"), async () => {
  await ask("/request", { request: "confirm-stick", digest: byId("confirm-stick").dataset.digest });
  say(tr("The stick is read again; leave it in, or plug it in again."));
});

function showHours(schedule) {
  const state = byId("hours-state");
  if (schedule === null) state.textContent = tr("This computer has no museum's settings.");
  else if (schedule.problem) state.textContent = schedule.problem;
  else if (schedule.override) {
    const until = dateText(schedule.override.until, schedule.zone, !schedule.override.is_today);
    state.textContent = schedule.override.open
      ? tr("Open until {until}, as an exception. Then the settings apply again.", { until })
      : tr("Closed until {until}, as an exception: projectors are off. Then the settings apply again.", { until });
  } else
    state.textContent =
      (schedule.open ? tr("Open now.") : tr("Closed now: the projectors are off.")) +
      (schedule.lines.length ? "" : " " + tr("Always open."));
  const problem = schedule ? schedule.override_problem : "";
  byId("hours-problem").hidden = !problem;
  byId("hours-problem").textContent = tr("The settings apply: {why}.", { why: problem });
  byId("hours-buttons").hidden = schedule === null || Boolean(schedule.problem);
  byId("hours-settings").hidden = !(schedule && (schedule.override || problem));
  byId("hours-until").title = schedule ? tr("In the time zone {zone}", schedule) : "";
  byId("hours").replaceChildren(...(schedule ? schedule.lines : []).map((line) => make("li", hoursText(line))));
}

press("hours-open", async () => {
  await ask("/hours", { do: "open", until: byId("hours-until").value });
  say(tr("The museum is open until then; after that the settings apply again."));
});
pressTwice("hours-closed", tr("Really close now?"), async () => {
  await ask("/hours", { do: "closed" });
  say(tr("The museum is closed until it opens on another day. “Back to the settings” undoes that."));
});
press("hours-settings", async () => {
  await ask("/hours", { do: "settings" });
  say(tr("The hours of the settings apply again."));
});

function showAlarms(alarms, zone) {
  byId("alarms-card").hidden = alarms === null;
  if (alarms === null) return;
  const ways = [alarms.mail && tr("by mail"), alarms.webhook && tr("by webhook")].filter(Boolean).join(", ");
  byId("alarms-state").textContent = [
    ways ? tr("Faults are reported {ways}.", { ways }) : tr("Nobody gets alarms: care.toml on the USB stick names nobody."),
    alarms.quiet && tr("Quiet from {from} to {to}.", { from: alarms.quiet.slice(0, 5), to: alarms.quiet.slice(6) }),
    alarms.delivered_at && tr("The last one was delivered at {time}.", { time: dateText(alarms.delivered_at, zone, true) }),
  ]
    .filter(Boolean)
    .join(" ");
  byId("alarms-problem").hidden = !alarms.problem;
  byId("alarms-problem").textContent = alarms.problem;
  byId("alarm-test").hidden = !ways;
}
press("alarm-test", async () => {
  await ask("/alarm-test", {}, 130);
  say(tr("A test was sent to everybody who gets alarms."));
});

function showSoftware(update, page) {
  const words = {
    current: tr("It is the newest."),
    checking: tr("Checking for a newer one."),
    loading: tr("A newer one is being fetched."),
    ready: tr("A newer one starts with the next restart, at night."),
    failed: tr("The newer one could not be fetched."),
    "rolled-back": tr("The newer one did not start well, so this one is in use again."),
  };
  byId("software-state").textContent =
    update === null
      ? tr("Version {version} of this page; the image's updater has not reported anything.", page)
      : `${tr("Version {version}.", update)} ${words[update.state]}${update.available ? ` (${update.available})` : ""}`;
  byId("software-buttons").hidden = !page.requests;
  if (page.recovery) byId("recovery").hidden = false;
}

press("recovery-key", async (button) => {
  const answer = await ask("/recovery-key", {});
  button.hidden = true;
  byId("recovery-words").textContent = tr("Write it down, and keep it where the museum keeps its keys: {key}", answer);
});

press("update", async () => {
  await ask("/request", { request: "update" });
  say(tr("Checking for an update; the show goes on."));
});
pressTwice("factory-reset", tr("Really delete settings and calibrations?"), async () => {
  await ask("/request", { request: "factory-reset" });
  say(tr("The computer restarts and deletes everything."));
});

// ---- Network, this page ----
press("network-test", async (button) => {
  const words = button.textContent;
  button.textContent = tr("Testing…");
  try {
    const answer = await ask("/network-test", {}, 60);
    byId("network").replaceChildren(...answer.checks.map(checkLine));
  } finally {
    button.textContent = words;
  }
});

function showPage(page) {
  byId("logout").hidden = !page.has_pin;
  const state = byId("page-state");
  state.textContent = page.has_pin
    ? tr(
        "The connection is encrypted. The SHA-256 fingerprint of its certificate, to compare with what the browser shows:",
      )
    : tr("It has no PIN and answers only on this computer.");
  if (page.fingerprint) state.append(make("span", " " + page.fingerprint, "print"));
}
press("logout", async () => {
  await ask("/logout", {});
  location.replace("/login.html");
});

repeat(1000, async () => {
  try {
    const answer = await get("/museum");
    if (answer.status === 401) location.replace("/login.html");
    if (answer.status === 404) return false; // A demo has no museum.
    const museum = await answer.json();
    byId("care").hidden = false;
    byId("install-link").hidden = false;
    showChecks(museum.checks);
    showCalibration(museum.calibration);
    showHealing(museum.watched);
    showSettings(museum.provisioning);
    showHours(museum.schedule);
    showAlarms(museum.alarms, museum.schedule?.zone);
    showVisits(museum.visits);
    showHistory(museum.history, museum.schedule?.zone);
    showSoftware(museum.update, museum.page);
    showPage(museum.page);
  } catch {
    // page.js shows that the page does not answer.
  }
  return true;
});
