// SPDX-License-Identifier: Apache-2.0
// The installer's way: one step at a time, saved as it is typed, resumed by whoever opens the page next.
import { byId, get, make, pause, post, repeat } from "./helpers.js";
import { drawCalibration, drawCameras, drawDone, drawFarm, drawName, drawNetwork, drawWall } from "./install_extras.js";
import { projectorFields, steps } from "./install_steps.js";
import { ask, press, say } from "./requests.js";
import { tr } from "./texts.js";

const extras = {
  name: drawName,
  network: drawNetwork,
  wall: drawWall,
  cameras: drawCameras,
  calibration: drawCalibration,
  farm: drawFarm,
  done: drawDone,
};

let setup = null; // The last answer of /setup.
let museum = null; // The last answer of /museum.
let current = null; // The step that is shown.
// What was typed here and is not saved yet, by step: {revision, fields}.
const mine = new Map();
let saving = Promise.resolve();
let timer = null;

const kept = (step) => setup.steps[step];
export const fieldsOf = (step) => mine.get(step)?.fields || kept(step).fields;

// ---- One step's fields ----
function fieldElement(field, value) {
  const box = make("div", undefined, "field");
  const id = `field-${field.name}`;
  const label = make("label", field.label);
  label.htmlFor = id;
  const input = make(field.options ? "select" : "input");
  input.id = id;
  input.name = field.name;
  if (field.options) {
    for (const [key, words] of field.options) {
      const option = make("option", words);
      option.value = key;
      input.append(option);
    }
  } else {
    input.type = "text";
    input.maxLength = 300;
    input.inputMode = field.isNumber ? "decimal" : "text";
    input.spellcheck = false;
  }
  input.value = value ?? "";
  const wrong = make("span", "", "wrong");
  wrong.id = `${id}-wrong`;
  input.setAttribute("aria-describedby", wrong.id);
  box.append(label, input);
  if (field.hint) box.append(make("span", field.hint, "hint"));
  box.append(wrong);
  box.dataset.field = field.name;
  return box;
}

const definitions = (step) =>
  step.name === "projectors" ? projectorFields(fieldsOf("projectors"), setup.plugged) : step.fields || [];

function drawFields() {
  const values = current.fields ? fieldsOf(current.name) : {};
  const form = byId("fields");
  const boxes = [];
  let group = null;
  for (const field of definitions(current)) {
    const options = typeof field.options === "function" ? field.options(setup, values[field.name]) : field.options;
    const box = fieldElement({ ...field, options }, values[field.name]);
    if (!field.group) boxes.push(box);
    else {
      if (group?.dataset.group !== field.group) {
        group = make("fieldset");
        group.dataset.group = field.group;
        group.append(make("legend", field.group));
        boxes.push(group);
      }
      group.append(box);
      if (field.after) group.append(projectorButtons(field.after));
    }
  }
  form.replaceChildren(...boxes);
  showWhen();
}

function projectorButtons(number) {
  const line = make("p", undefined, "buttons");
  const button = (words, label, work) => {
    const one = make("button", words);
    one.type = "button";
    one.setAttribute("aria-label", label);
    one.addEventListener("click", work);
    line.append(one);
  };
  const name = fieldsOf("projectors")[`${number}.name`] || `projector ${number}`;
  button(tr("Let it blink"), tr("Let it blink: {name}", { name }), () => blink(number));
  if (number > 1) button(tr("To the left"), tr("To the left: {name}", { name }), () => swap(number, number - 1));
  return line;
}

async function blink(number) {
  try {
    await ask("/setup/blink", { projector: fieldsOf("projectors")[`${number}.name`] });
    say(tr("It blinks for six seconds; all others are dark."));
  } catch (problem) {
    say(tr("That did not work: {why}", { why: problem.message }), true);
  }
}

function swap(a, b) {
  const fields = { ...fieldsOf("projectors") };
  for (const key of ["name", "connector", "turn_deg", "pjlink"])
    [fields[`${a}.${key}`], fields[`${b}.${key}`]] = [fields[`${b}.${key}`] ?? "", fields[`${a}.${key}`] ?? ""];
  change(fields);
  drawFields();
}

// Fields that belong to another choice are hidden, and keep what was typed.
function showWhen() {
  const values = current.fields ? fieldsOf(current.name) : {};
  for (const field of definitions(current)) {
    const box = byId("fields").querySelector(`[data-field="${field.name}"]`);
    if (box) box.hidden = Boolean(field.when && !field.when(values));
  }
}

// ---- Saving: as it is typed, half a second after the last key ----
function change(fields) {
  const before = mine.get(current.name);
  mine.set(current.name, { revision: before ? before.revision : kept(current.name).revision, fields });
  byId("use").disabled = true;
  clearTimeout(timer);
  timer = setTimeout(save, 500, current.name);
  showWhen();
}

export function save(step) {
  clearTimeout(timer);
  saving = saving.then(() => saveNow(step)).catch(() => {});
  return saving;
}

async function saveNow(step) {
  const typed = mine.get(step);
  if (!typed || typed.conflict) return;
  try {
    const answer = await post("/setup/step", { step, revision: typed.revision, fields: typed.fields }, 10000);
    if (answer.status === 401) location.replace("/login.html");
    const json = await answer.json();
    if (answer.status === 409) typed.conflict = json;
    else if (!answer.ok) throw new Error(json.error);
    else {
      setup.steps[step] = { ...kept(step), ...json, in_use: false };
      // What was typed while this was on its way is saved next, on top of it.
      if (mine.get(step) === typed) mine.delete(step);
      else mine.get(step).revision = json.revision;
    }
  } catch (problem) {
    say(tr("Not saved yet: {why}. It is tried again.", { why: problem.message }), true);
    timer = setTimeout(save, 2000, step);
  }
  show();
}

byId("fields").addEventListener("input", (event) => {
  const fields = { ...fieldsOf(current.name), [event.target.name]: event.target.value };
  change(fields);
  if (event.target.name === "count") drawFields();
});
byId("fields").addEventListener("submit", (event) => event.preventDefault());

// ---- Two people at once ----
function showConflict() {
  const typed = mine.get(current.name);
  const theirs = typed?.conflict;
  byId("conflict").hidden = !theirs;
  if (!theirs) return;
  byId("conflict-words").textContent = tr("Somebody else ({by}) has changed this step meanwhile.", theirs);
  const names = Object.keys({ ...typed.fields, ...theirs.fields }).filter(
    (name) => (typed.fields[name] ?? "") !== (theirs.fields[name] ?? ""),
  );
  byId("conflict-fields").replaceChildren(
    ...names.map((name) => {
      const label = definitions(current).find((field) => field.name === name)?.label || name;
      return make(
        "li",
        tr("{label}: theirs is “{theirs}”, yours is “{yours}”.", {
          label,
          theirs: theirs.fields[name] ?? "",
          yours: typed.fields[name] ?? "",
        }),
      );
    }),
  );
}
byId("take-theirs").addEventListener("click", () => {
  setup.steps[current.name] = { ...kept(current.name), ...mine.get(current.name).conflict };
  mine.delete(current.name);
  drawFields();
  show();
});
byId("keep-mine").addEventListener("click", () => {
  const typed = mine.get(current.name);
  typed.revision = typed.conflict.revision;
  delete typed.conflict;
  save(current.name);
});

// ---- State of the steps ----
function stateOf(step) {
  if (step.state) return step.state(setup, museum);
  const known = kept(step.name);
  if (known.in_use) return "used";
  return known.problems.length > 0 ? (known.revision > 0 ? "wrong" : "open") : "ready";
}

const stateWords = {
  used: tr("in use"),
  ready: tr("ready to use"),
  wrong: tr("something is wrong"),
  open: tr("to be done"),
};

function missingOf(step) {
  if (step.missing) return step.missing(setup, museum);
  const known = kept(step.name);
  if (known.in_use) return tr("These settings are in use.");
  if (known.problems.length === 0) return tr("Complete, but not in use yet: press the button below.");
  const first = known.problems[0];
  const label = definitions(step).find((field) => field.name === first.field)?.label;
  return tr("Still missing: {what}", { what: `${label ? `${label}. ` : ""}${first.sentence}` });
}

function showSteps() {
  const list = byId("steps");
  if (list.children.length === 0) {
    steps.forEach((step, i) => {
      const button = make("button", `${i + 1}. ${step.title}`);
      button.type = "button";
      button.dataset.step = step.name;
      button.addEventListener("click", () => go(step.name));
      const item = make("li");
      item.append(button);
      list.append(item);
    });
  }
  steps.forEach((step, i) => {
    const button = list.children[i].firstChild;
    const state = stateOf(step);
    button.className = state;
    button.setAttribute("aria-label", `${i + 1}. ${step.title}: ${stateWords[state]}`);
    if (step === current) button.setAttribute("aria-current", "step");
    else button.removeAttribute("aria-current");
  });
}

function showProblems() {
  const problems = new Map((kept(current.name)?.problems || []).map((one) => [one.field, one.sentence]));
  for (const box of byId("fields").querySelectorAll(".field")) {
    const input = box.querySelector("input, select");
    // A field that nobody has touched is missing, not wrong.
    const sentence = kept(current.name).revision > 0 ? problems.get(box.dataset.field) || "" : "";
    const place = box.querySelector(".wrong");
    if (place.textContent !== sentence) place.textContent = sentence;
    input.setAttribute("aria-invalid", sentence ? "true" : "false");
  }
}

function show() {
  showSteps();
  const isKept = current.name in setup.steps;
  const state = stateOf(current);
  byId("step-missing").textContent = missingOf(current);
  byId("step-missing").classList.toggle("well", state === "used");
  byId("use-buttons").hidden = !isKept || !setup.can_change;
  byId("use").textContent = current.use || tr("Use these settings");
  byId("use").disabled =
    !isKept || state !== "ready" || setup.is_checking || mine.has(current.name) || setup.network.state === "trying";
  if (isKept) {
    showProblems();
    showConflict();
  } else byId("conflict").hidden = true;
  const at = steps.indexOf(current);
  byId("previous-step").disabled = at === 0;
  byId("next-step").disabled = at === steps.length - 1;
  const open = steps.filter((step) => stateOf(step) !== "used").length;
  byId("state").textContent = setup.is_checking
    ? tr("The settings are being checked…")
    : open === 0
      ? tr("Everything is in use.")
      : tr("{n} of {all} steps are done.", { n: steps.length - open, all: steps.length });
  extras[current.name]?.(byId("extra"), setup, museum);
}

export function go(name) {
  if (current && mine.has(current.name)) save(current.name);
  const step = steps.find((one) => one.name === name) || steps[0];
  if (step === current) return;
  current = step;
  if (location.hash !== `#${step.name}`) history.pushState(null, "", `#${step.name}`);
  byId("step-title").textContent = step.title;
  byId("step-intro").textContent = step.intro;
  byId("extra").replaceChildren();
  say("");
  drawFields();
  show();
  byId("step-title").focus();
}
addEventListener("popstate", () => go(location.hash.slice(1)));
byId("previous-step").addEventListener("click", () => go(steps[steps.indexOf(current) - 1].name));
byId("next-step").addEventListener("click", () => go(steps[steps.indexOf(current) + 1].name));

// ---- Into use ----
press("use", async (button) => {
  const step = current.name;
  await save(step);
  const answer = await ask("/setup/use", { step, revision: kept(step).revision }, 30);
  if (answer.code) sessionStorage.setItem("network-code", answer.code);
  say(answer.code ? "" : tr("They are checked as a whole; that takes some seconds."));
  while (!answer.code) {
    await pause(500);
    await look();
    if (!setup.is_checking) break;
  }
  if (!answer.code) {
    const report = museum?.provisioning;
    const isRefused = report && report.verdict === "refused";
    say(isRefused ? tr("Refused: {why}", { why: report.problems.join(" ") }) : tr("They are in use."), isRefused);
  }
  button.disabled = false;
});

// Fields follow what others save, unless something is being typed here.
function follow(old) {
  if (!current || !(current.name in setup.steps) || mine.has(current.name)) return;
  if (!old || old.steps[current.name].revision === kept(current.name).revision) return;
  drawFields();
  say(tr("Changed by {by}.", kept(current.name)));
}

async function look() {
  const [first, second] = await Promise.all([get("/setup"), get("/museum")]);
  if (first.status === 401) location.replace("/login.html");
  const old = setup;
  const found = await first.json();
  // An answer from before a change that was saved meanwhile is old for that step.
  for (const [name, step] of Object.entries(setup?.steps || {}))
    if (step.revision > found.steps[name].revision) found.steps[name] = step;
  setup = found;
  museum = second.ok ? await second.json() : null;
  if (!current) go(location.hash.slice(1) || steps[0].name);
  follow(old);
  show();
}

repeat(1000, async () => {
  try {
    await look();
  } catch {
    byId("state").textContent = setup
      ? tr("The page does not answer; what you type is kept here and saved as soon as it does.")
      : tr("The page does not answer yet.");
  }
});
