"use strict";
// Programs that drive a block in place of a scenario's commands: what is shown first in the page's editor.

/** What is in the editor where nothing else is: it does nothing. */
const NO_PROGRAM = `// Runs before each step, like a PLC's cycle. knob(name, start, low, high, unit) makes a slider.
// block.get(name), block.set({name: value}); master.position, .velocity, .acceleration

return (t, block, master) => {
};`;

/** By block: a title, the scenario whose machine and line are taken, and the text. */
const PROGRAMS = {
  FlyingSaw: {
    title: "Program: cut to length",
    scenario: "cyclic_cut",
    text: `// A PLC's program in place of the scenario's commands: it cuts a piece each "piece" mm, at any velocity of the line.
const piece = knob("piece", 1500, 600, 3000, "mm");
const meet = knob("meets at", 250, 50, 600, "mm");
const cutting = knob("cutting takes", 0.2, 0.02, 0.6, "s");
const home = knob("order from", 200, 20, 500, "mm");
scenario.cuts.length = piece; // the marks in the picture
scenario.cuts.offset = 0;
let cut = 1, since = -1, ordered = 0, later = 0;

return (t, saw, master) => { // before each step
  const ahead = () => cut * piece + meet - master.position; // of the meeting
  if (ordered === cut && saw.get("gear_in_pos.error")) { // refused: it is too late for this mark
    saw.set({"gear_in_pos.execute": false});
    ordered = 0;
    cut++;
    later = t + 0.02;
  } else if (t >= later && master.velocity > 100 && ordered < cut && saw.get("slave.position") < home) {
    while (ahead() < 500) cut++; // the first mark that can be met
    saw.set({ // home, or on the way: the next cut
      "move_absolute.execute": false,
      "gear_in_pos.master_sync_position": cut * piece + meet,
      "gear_in_pos.slave_sync_position": meet,
      "gear_in_pos.execute": true,
    });
    ordered = cut;
  }
  if (!saw.get("in_sync")) since = -1;
  else if (since < 0) since = t;
  else if (t - since > cutting) { // the blade is through
    cut++;
    since = -1;
    saw.set({"gear_in_pos.execute": false, "move_absolute.execute": true});
  }
};`,
  },
};
