// Entry of the page of participants.
import { VrPage } from "./page.mjs";

window.crowdbotVr = new VrPage(document.getElementById("vr"));
