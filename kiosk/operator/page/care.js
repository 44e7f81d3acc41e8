// SPDX-License-Identifier: Apache-2.0
// What a museum asks of its people, and what they may ask of it. byId() and make() are page.js's.
"use strict";

const say = (text, isWrong) => {
  byId("care-note").textContent = text;
  byId("care-note").classList.toggle("wrong", Boolean(isWrong));
};

async function ask(path, body, seconds = 10) {
  const answer = await fetch(path, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body),
                                     signal: AbortSignal.timeout(1000 * seconds) });
  if (answer.status === 401) location.replace("/login.html");
  const text = await answer.text();
  const json = text ? JSON.parse(text) : {};
  if (!answer.ok) throw new Error(json.error);
  return json;
}

// One request at a time from one button, and its refusal in words.
function press(id, work) {
  const button = byId(id);
  button.addEventListener("click", async () => {
    button.disabled = true;
    say("");
    try {
      await work(button);
    } catch (problem) {
      say(`That did not work: ${problem.message}`, true);
    }
    button.disabled = false;
  });
}

// What cannot be undone is pressed twice.
function pressTwice(id, question, work) {
  const words = byId(id).textContent;
  let sureUntil = 0;
  const calm = (button) => { button.textContent = words; button.classList.remove("sure"); };
  press(id, async (button) => {
    if (Date.now() > sureUntil) {
      sureUntil = Date.now() + 6000;
      button.textContent = question;
      button.classList.add("sure");
      setTimeout(calm, 6000, button);
      return;
    }
    sureUntil = 0;
    calm(button);
    await work();
  });
}

// ---- Checks ----
function checkLine(check) {
  const item = make("li", undefined, check.level);
  const words = make("span", `${check.title}: ${check.sentence}`);
  if (check.remedy) words.append(make("span", check.remedy, "remedy"));
  item.append(words);
  return item;
}

function showChecks(checks) {
  const rank = { fault: 0, warning: 1, ok: 2 };
  const wrong = checks.filter((check) => check.level !== "ok").sort((a, b) => rank[a.level] - rank[b.level]);
  byId("needs-section").hidden = wrong.length === 0;
  byId("needs").replaceChildren(...wrong.map((check) => {
    const item = make("li", undefined, check.level);
    item.append(make("h3", check.title), make("p", check.sentence));
    if (check.remedy) item.append(make("p", check.remedy, "remedy"));
    return item;
  }));
  byId("checks-summary").textContent = `Everything that is looked at: ${checks.length - wrong.length} of ${checks.length} are well`;
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
    idle: "The wall is measured with a camera, so that the projectors make one picture. Nobody should stand in it meanwhile.",
    running: isOfWall ? `${Math.round(100 * calibration.fraction)} %: ${calibration.step}` : `It ${calibration.step}.`,
    done: !isOfWall ? "Where the fixed cameras stand:" : `Measured on ${calibration.date}.` + (isNumber(calibration.registration_p95_px)
      ? ` Neighbouring pictures meet within ${calibration.registration_p95_px.toFixed(2)} px in 95 of 100 places.` : ""),
    cancelled: !isOfWall ? "Cancelled; the fixed cameras count as before." : "Cancelled; the wall shows the calibration of before. What was photographed is kept: the next one can go on from there.",
    failed: `It failed: ${calibration.error}`,
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

// One projector that was pushed; page.js knows their names.
function showPieces(isRunning) {
  const names = [...projectors.keys()].map((key) => key.slice(key.indexOf("/projector/") + "/projector/".length));
  const select = byId("quick-projector");
  if (names.join("\n") !== [...select.options].map((option) => option.value).join("\n")) {
    select.replaceChildren(...names.map((name) => make("option", name)));
  }
  byId("quick-one").hidden = names.length === 0;
  byId("calibrate-parts").hidden = isRunning;
}

press("calibrate", () => ask("/calibration", { do: "start" }));
press("calibrate-resume", () => ask("/calibration", { do: "start", resume: true }));
press("calibrate-quick", () => ask("/calibration", { do: "start", quick: true, projector: byId("quick-projector").value }));
press("place-cameras", () => ask("/calibration", { do: "place-cameras" }));
press("calibration-done", async () => {
  await ask("/calibration", { do: "answer", text: byId("calibration-answer").value });
  byId("calibration-answer").value = "";
});
byId("calibration-answer").addEventListener("keydown", (event) => {
  if (event.key === "Enter") byId("calibration-done").click();
});
press("calibrate-cancel", () => ask("/calibration", { do: "cancel" }));
pressTwice("calibrate-restore", "Really bring it back?", async () => {
  const answer = await ask("/calibration", { do: "restore" }, 35);
  say(`The calibration of ${answer.date} is in use again.`);
});

// ---- Settings, hours, software ----
function showSettings(provisioning) {
  const words = { installed: "Those of the last stick are in use.", unchanged: "The last stick had the same settings as those in use.",
                  restored: "Those of before are in use again.", refused: "The last stick was refused." };
  byId("settings-state").textContent = provisioning === null ? "No stick was ever plugged in."
    : `${words[provisioning.verdict]} ${provisioning.museum ? `Museum “${provisioning.museum}”, ` : ""}${provisioning.projectors} projectors.`;
  const sentences = provisioning === null ? [] : [...provisioning.problems, ...provisioning.remarks];
  byId("settings-remarks").replaceChildren(...sentences.map((sentence) => make("li", sentence)));
}

function showHours(schedule) {
  const state = byId("hours-state");
  if (schedule === null) state.textContent = "This computer has no settings of a museum.";
  else if (schedule.problem) state.textContent = schedule.problem;
  else if (schedule.override) {
    state.textContent = schedule.override.open ? `Open until ${schedule.override.until}, for this once. Then as the settings say.`
      : `Closed until ${schedule.override.until}, for this once: the projectors are off. Then as the settings say.`;
  } else state.textContent = (schedule.open ? "Open now." : "Closed now: the projectors are off.") + (schedule.lines.length ? "" : " Always open.");
  const problem = schedule ? schedule.override_problem : "";
  byId("hours-problem").hidden = !problem;
  byId("hours-problem").textContent = `As the settings say: ${problem}.`;
  byId("hours-buttons").hidden = schedule === null || Boolean(schedule.problem);
  byId("hours-settings").hidden = !(schedule && (schedule.override || problem));
  byId("hours-until").title = schedule ? `By the clocks of ${schedule.zone}` : "";
  byId("hours").replaceChildren(...(schedule ? schedule.lines : []).map((line) => make("li", line)));
}

press("hours-open", async () => {
  await ask("/hours", { do: "open", until: byId("hours-until").value });
  say("The museum is open until then, whatever the settings say; after that as they say.");
});
pressTwice("hours-closed", "Really close now?", async () => {
  await ask("/hours", { do: "closed" });
  say("The museum is closed until it opens on another day. “As the settings say” takes that back.");
});
press("hours-settings", async () => {
  await ask("/hours", { do: "settings" });
  say("The hours are those of the settings again.");
});

function showSoftware(update, page) {
  const words = { current: "It is the newest.", checking: "Looks for a newer one.", loading: "A newer one is being fetched.",
                  ready: "A newer one begins with the next start, at night.", failed: "The newer one could not be had.",
                  "rolled-back": "The newer one did not start well, so this one was taken back." };
  byId("software-state").textContent = update === null ? `Version ${page.version} of this page; the image's updater has not said anything.`
    : `Version ${update.version}. ${words[update.state]}${update.available ? ` (${update.available})` : ""}`;
  byId("software-buttons").hidden = !page.wishes;
}

press("update", async () => {
  await ask("/wish", { wish: "update" });
  say("It looks for an update now; the show goes on.");
});
pressTwice("factory-reset", "Really forget settings and calibrations?", async () => {
  await ask("/wish", { wish: "factory-reset" });
  say("The computer starts again and forgets everything.");
});

// ---- Network, this page ----
press("network-test", async (button) => {
  const words = button.textContent;
  button.textContent = "Testing…";
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
  state.textContent = page.has_pin ? "The way to it is encrypted. Its certificate's SHA-256 fingerprint, to compare with what the browser shows:"
                                   : "It asks for no PIN, and answers on this computer alone.";
  if (page.fingerprint) state.append(make("span", " " + page.fingerprint, "print"));
}
press("logout", async () => {
  await ask("/logout", {});
  location.replace("/login.html");
});

async function watchMuseum() {
  for (;;) {
    if (!document.hidden) {
      try {
        const answer = await fetch("/museum", { signal: AbortSignal.timeout(5000) });
        if (answer.status === 401) location.replace("/login.html");
        if (answer.status === 404) return;  // A demo without a museum.
        const museum = await answer.json();
        byId("care").hidden = false;
        showChecks(museum.checks);
        showCalibration(museum.calibration);
        showHealing(museum.watched);
        showSettings(museum.provisioning);
        showHours(museum.schedule);
        showSoftware(museum.update, museum.page);
        showPage(museum.page);
      } catch {
        // page.js says that the page does not answer.
      }
    }
    await new Promise((done) => setTimeout(done, 1000));
  }
}
watchMuseum();
