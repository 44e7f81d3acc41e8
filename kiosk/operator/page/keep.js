// SPDX-License-Identifier: Apache-2.0
// Confirms a network from the address that it gave this computer. The code after the # comes from the page that tried it.
import { byId, post } from "./helpers.js";
import { tr } from "./texts.js";

byId("keep").addEventListener("click", async () => {
  byId("keep").disabled = true;
  try {
    const answer = await post("/setup/keep", { code: location.hash.slice(1) }, 10000);
    if (!answer.ok) throw new Error((await answer.json()).error);
    byId("note").textContent = tr("The settings are kept.");
    byId("keep").hidden = true;
  } catch (problem) {
    byId("note").textContent = tr("That did not work: {why}", { why: problem.message });
    byId("keep").disabled = false;
  }
});
