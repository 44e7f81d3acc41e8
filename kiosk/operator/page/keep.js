// SPDX-License-Identifier: Apache-2.0
// Confirms a network from the address that it gave this computer. The code after the # comes from the page that tried it.
import { byId, post } from "./helpers.js";

byId("keep").addEventListener("click", async () => {
  byId("keep").disabled = true;
  try {
    const answer = await post("/setup/keep", { code: location.hash.slice(1) }, 10000);
    if (!answer.ok) throw new Error((await answer.json()).error);
    byId("note").textContent = "The settings are kept.";
    byId("keep").hidden = true;
  } catch (problem) {
    byId("note").textContent = `That did not work: ${problem.message}.`;
    byId("keep").disabled = false;
  }
});
