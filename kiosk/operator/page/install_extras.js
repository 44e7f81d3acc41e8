// SPDX-License-Identifier: Apache-2.0
// What a step shows besides its fields. Each function is called every second: it makes its elements once, and then only
// changes their words, so that a button keeps the focus.
import { make, makeSvg } from "./helpers.js";
import { ask, say } from "./requests.js";
import { tr } from "./texts.js";

// Makes the elements when the step is shown first.
function once(place, name, build) {
  if (place.dataset.step === name && place.children.length > 0) return;
  place.dataset.step = name;
  place.replaceChildren(...build());
}

function button(id, words, work) {
  const one = make("button", words);
  one.type = "button";
  one.id = id;
  one.addEventListener("click", async () => {
    one.disabled = true;
    try {
      await work(one);
    } catch (problem) {
      say(tr("That did not work: {why}", { why: problem.message }), true);
    }
    one.disabled = false;
  });
  return one;
}

function buttons(...all) {
  const line = make("p", undefined, "buttons");
  line.append(...all);
  return line;
}

function link(href, words, isFile) {
  const one = make("a", words, "button");
  one.href = href;
  if (isFile) one.download = "";
  return one;
}

const part = (place, id) => place.querySelector(`#${id}`);
function words(place, id, text) {
  const element = part(place, id);
  if (element.textContent !== text) element.textContent = text;
}
function element(tag, id, text) {
  const one = make(tag, text);
  one.id = id;
  return one;
}

// A file that belongs to a step; its name there is fixed, whatever it is called on the stick or phone.
function fileField(step, name, label) {
  const box = make("div", undefined, "field");
  const input = make("input");
  input.type = "file";
  input.id = `file-${name.replace(/[^a-z0-9]/g, "-")}`;
  const title = make("label", label);
  title.htmlFor = input.id;
  const state = make("span", "", "hint");
  state.dataset.file = name;
  input.addEventListener("change", async () => {
    const file = input.files[0];
    if (!file) return;
    try {
      if (file.size > 48000) throw new Error(tr("{name} is too large for a certificate or key", file));
      await ask("/setup/bring", { step, name, content: await file.text() });
      say(tr("{name} is here.", file));
    } catch (problem) {
      input.value = "";
      say(tr("That did not work: {why}", { why: problem.message }), true);
    }
  });
  box.append(title, input, state);
  return box;
}

function showFiles(place, step) {
  for (const state of place.querySelectorAll("[data-file]"))
    state.textContent = (step.brought || []).includes(state.dataset.file) ? tr("It is here.") : tr("Not brought yet.");
}

// ---- Name, PIN, recovery key ----
export function drawName(place, setup, museum) {
  once(place, "name", () => [
    element("p", "pin-state"),
    element("p", "key-state"),
    buttons(
      button("key-show", tr("Show the recovery key"), async () => {
        const answer = await ask("/recovery-key", {});
        say("");
        part(place, "key-state").dataset.key = answer.key;
      }),
    ),
  ]);
  words(
    place,
    "pin-state",
    setup.has_pin ? tr("The PIN is set. You have logged in with it.") : tr("This page runs without a PIN."),
  );
  const key = part(place, "key-state").dataset.key;
  const isThere = Boolean(museum?.page.recovery) && !key;
  part(place, "key-show").hidden = !isThere;
  words(
    place,
    "key-state",
    key
      ? tr("Write it down, and keep it where the museum keeps its keys: {key}", { key })
      : isThere
        ? tr("The recovery key opens the settings after a repair. It is shown once.")
        : tr("The recovery key was shown already, or this computer has none."),
  );
}

// ---- Network ----
function newAddresses(fields) {
  const port = location.port ? `:${location.port}` : "";
  const all = [];
  if (fields.ipv4 === "static" && fields.ipv4_address) all.push(`https://${fields.ipv4_address.split("/")[0]}${port}`);
  if (fields.ipv6 === "static" && fields.ipv6_address)
    all.push(`https://[${fields.ipv6_address.split("/")[0]}]${port}`);
  return all;
}

export function drawNetwork(place, setup) {
  once(place, "network", () => {
    const trial = element("div", "network-trial");
    trial.className = "try";
    trial.hidden = true;
    trial.append(
      element("p", "trial-words"),
      element("p", "trial-links"),
      buttons(
        button("network-keep", tr("Keep these settings"), async () => {
          await ask("/setup/keep", { code: sessionStorage.getItem("network-code") || "" });
          say(tr("They are kept, and checked as a whole now."));
        }),
      ),
    );
    const files = element("details", "login-files");
    files.append(
      make("summary", tr("Files for the login at the switch")),
      fileField("network", "8021x-authority.crt", "Authority's certificate"),
      fileField("network", "8021x-password", tr("Password, alone in a text file")),
      fileField("network", "8021x-certificate.crt", tr("This computer's certificate")),
      fileField("network", "8021x-key.pem", tr("Its key")),
    );
    return [trial, element("p", "trial-end"), files];
  });
  showFiles(place, setup.steps.network);
  const { state, sentence } = setup.network;
  const code = sessionStorage.getItem("network-code");
  part(place, "network-trial").hidden = state !== "trying";
  words(
    place,
    "trial-words",
    tr(
      "The new network is being tried. If you read this, this page can still be reached: confirm it within a minute, or it is taken back.",
    ),
  );
  const links = part(place, "trial-links");
  const wanted = code ? newAddresses(setup.steps.network.fields).map((one) => `${one}/keep.html#${code}`) : [];
  if (links.dataset.wanted !== wanted.join()) {
    links.dataset.wanted = wanted.join();
    links.replaceChildren(
      ...wanted.flatMap((href) => [tr("With the new address, confirm it there: "), link(href, href.split("#")[0])]),
    );
  }
  words(
    place,
    "trial-end",
    state === "taken-back"
      ? tr("The last trial was taken back: {why}.", { why: sentence })
      : state === "kept"
        ? tr("The last trial was confirmed.")
        : "",
  );
}

// ---- Wall: drawn to scale, unrolled ----
function wallPicture(wall) {
  const margin = 0.6;
  const height = wall.top_m + margin;
  const svg = makeSvg("svg", {
    viewBox: `${-margin} ${-height} ${wall.length_m + 2 * margin} ${height + 0.3}`,
    role: "img",
    "aria-label": tr("The wall, {m} m long, unrolled; the pictures light {lit} % of it", {
      m: wall.length_m.toFixed(2),
      lit: Math.round(100 * wall.lit),
    }),
  });
  const add = (tag, attributes) => svg.append(makeSvg(tag, attributes));
  const text = (x, y, value) => {
    const one = makeSvg("text", { x, y, "text-anchor": "middle" });
    one.textContent = value;
    svg.append(one);
  };
  add("rect", {
    x: 0,
    y: -wall.top_m,
    width: wall.length_m,
    height: wall.top_m - wall.bottom_m,
    class: "wall-rect",
  });
  for (const picture of wall.pictures) {
    add("polygon", {
      points: picture.points.map(([x, y]) => `${x.toFixed(3)},${(-y).toFixed(3)}`).join(" "),
      class: "reach",
    });
    const middle = picture.points.reduce((sum, [x]) => sum + x, 0) / Math.max(1, picture.points.length);
    text(middle, -(wall.top_m + wall.bottom_m) / 2, picture.name);
  }
  add("line", { x1: -margin, x2: wall.length_m + margin, y1: 0, y2: 0, class: "ground" });
  const x = wall.length_m / 2;
  add("path", { d: `M${x},0 V${-wall.eye_m + 0.12} M${x - 0.2},${-wall.eye_m + 0.45} H${x + 0.2}`, class: "visitor" });
  add("circle", { cx: x, cy: -wall.eye_m, r: 0.12, class: "visitor" });
  text(wall.length_m / 2, -wall.top_m - 0.15, `${wall.length_m.toFixed(2)} m`);
  return svg;
}

export function drawWall(place, setup) {
  once(place, "wall", () => [element("div", "wall-picture"), element("p", "wall-words"), element("ul", "wall-hints")]);
  const key = JSON.stringify(setup.wall);
  if (place.dataset.wall === key && part(place, "wall-picture").children.length > 0) return;
  place.dataset.wall = key;
  const wall = setup.wall;
  part(place, "wall-picture").replaceChildren(...(wall ? [wallPicture(wall)] : []));
  words(
    place,
    "wall-words",
    wall
      ? tr("The projectors light {lit} % of the wall, and {twice} % of it twice, for the seams.", {
          lit: Math.round(100 * wall.lit),
          twice: Math.round(100 * wall.shared),
        })
      : tr("The wall is drawn as soon as its lengths and the projectors are known."),
  );
  part(place, "wall-hints").replaceChildren(...(wall ? wall.hints : []).map((hint) => make("li", hint)));
}

// ---- Camera and its lens ----
export function drawCameras(place, setup) {
  once(place, "cameras", () => [
    fileField("cameras", "camera.json", tr("Its lens file, camera.json")),
    make("p", tr("It is made from pictures of the board; without it the calibration begins with an estimate."), "note"),
    buttons(
      link("/setup/board.pdf", tr("The board, to print (PDF)"), true),
      link("/setup/wand.pdf", tr("A wand, to print and fold (PDF)"), true),
    ),
  ]);
  showFiles(place, setup.steps.cameras);
}

// ---- Calibration ----
let calibrationPicture = 0;

export function drawCalibration(place, setup, museum) {
  once(place, "calibration", () => {
    const bar = element("progress", "calibration-progress");
    bar.max = 1;
    bar.setAttribute("aria-label", tr("Progress of the calibration"));
    const image = element("img", "calibration-picture");
    image.alt = tr("The picture of the calibration camera");
    const question = element("div", "calibration-question");
    question.className = "field";
    const label = element("label", "calibration-asked");
    label.htmlFor = "calibration-answer";
    const input = element("input", "calibration-answer");
    input.type = "text";
    input.maxLength = 20;
    question.append(
      label,
      input,
      buttons(
        button("calibration-reply", tr("Done"), async () => {
          await ask("/calibration", { do: "answer", text: input.value });
          input.value = "";
        }),
      ),
    );
    return [
      buttons(
        button("calibration-start", tr("Measure the wall"), () => ask("/calibration", { do: "start" })),
        button("calibration-resume", tr("Resume"), () => ask("/calibration", { do: "start", resume: true })),
        button("calibration-cancel", tr("Cancel"), () => ask("/calibration", { do: "cancel" })),
      ),
      element("p", "calibration-words"),
      bar,
      question,
      image,
      element("ul", "calibration-remarks"),
      element("p", "calibration-report"),
    ];
  });
  const run = museum?.calibration;
  const state = run?.state || "none";
  part(place, "calibration-start").disabled = !run || state === "running";
  part(place, "calibration-resume").hidden = state !== "cancelled" && state !== "failed";
  part(place, "calibration-cancel").hidden = state !== "running";
  part(place, "calibration-progress").hidden = state !== "running";
  part(place, "calibration-progress").value = run?.fraction || 0;
  part(place, "calibration-question").hidden = !run?.question;
  words(place, "calibration-asked", run?.question || "");
  words(
    place,
    "calibration-words",
    !run
      ? tr("The calibrator is not watched by this page.")
      : state === "running"
        ? `${Math.round(100 * run.fraction)} %: ${run.step}`
        : state === "failed"
          ? tr("It failed: {why}", { why: run.error })
          : state === "done"
            ? tr("Measured on {date}.", run)
            : "",
  );
  const image = part(place, "calibration-picture");
  image.hidden = state !== "running" || !run.has_picture;
  if (!image.hidden) image.src = `/calibration.jpg?${++calibrationPicture}`;
  part(place, "calibration-remarks").replaceChildren(...(run?.remarks || []).map((remark) => make("li", remark)));
  const report = part(place, "calibration-report");
  if (setup.has_calibration && report.children.length === 0) {
    report.append(link("/setup/report.html", tr("The report, with photographs of each seam")));
    report.firstChild.target = "_blank";
  }
}

// ---- Farm ----
export function drawFarm(place, setup) {
  once(place, "farm", () => [
    make("h3", tr("The three files of this museum's bundle")),
    fileField("farm", "tls/authority.crt", "authority.crt"),
    fileField("farm", "tls/certificate.crt", "certificate.crt"),
    fileField("farm", "tls/key.pem", "key.pem"),
    make("p", tr("Or bring them with all settings on a USB stick."), "note"),
    buttons(
      button("farm-test", tr("Test the way to the farm"), async () => {
        const answer = await ask("/network-test", {}, 60);
        part(place, "farm-result").replaceChildren(
          ...answer.checks.map((check) => {
            const item = make("li", undefined, check.level);
            const text = make("span", `${check.title}: ${check.sentence}`);
            if (check.remedy) text.append(make("span", check.remedy, "remedy"));
            item.append(text);
            return item;
          }),
        );
      }),
    ),
    Object.assign(element("ul", "farm-result"), { className: "checks" }),
  ]);
  showFiles(place, setup.steps.farm);
}

// ---- Done ----
export function drawDone(place, setup, museum) {
  once(place, "done", () => [
    Object.assign(element("ul", "done-checks"), { className: "checks" }),
    buttons(
      link("/setup/sheet.pdf", tr("The sheet for the office (PDF)"), true),
      link("/", tr("To the operator's page")),
    ),
  ]);
  const checks = (museum?.checks || []).filter((check) => check.level !== "ok");
  part(place, "done-checks").replaceChildren(
    ...(checks.length > 0
      ? checks.map((check) => make("li", `${check.title}: ${check.sentence} ${check.remedy}`, check.level))
      : [make("li", tr("All checks of the operator's page are well."), "ok")]),
  );
}
