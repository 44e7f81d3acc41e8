// SPDX-License-Identifier: Apache-2.0
// Buttons that send a request to cyclorama-operator and show its result in words.
import { byId, post } from "./helpers.js";
import { tr } from "./texts.js";

export function say(text, isWrong) {
  byId("care-note").textContent = text;
  byId("care-note").classList.toggle("wrong", Boolean(isWrong));
}

// Returns the answer's JSON. Throws the program's own sentence when the request is refused.
export async function ask(path, body, seconds = 10) {
  const answer = await post(path, body, 1000 * seconds);
  if (answer.status === 401) location.replace("/login.html");
  const text = await answer.text();
  const json = text ? JSON.parse(text) : {};
  if (!answer.ok) throw new Error(json.error);
  return json;
}

// A button has one request at a time; a refusal is shown in words.
export function press(id, work) {
  const button = byId(id);
  button.addEventListener("click", async () => {
    button.disabled = true;
    say("");
    try {
      await work(button);
    } catch (problem) {
      say(tr("That did not work: {why}", { why: problem.message }), true);
    }
    button.disabled = false;
  });
}

// A button whose effect cannot be undone is pressed twice.
export function pressTwice(id, question, work) {
  const words = byId(id).textContent;
  let sureUntil = 0;
  const calm = (button) => {
    button.textContent = words;
    button.classList.remove("sure");
  };
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
