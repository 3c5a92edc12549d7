// How often the page is drawn while nobody touches it. Where the processor draws, it may be the one that the run needs.

/// Of one core, for a page that is only looked at.
const calmShare = 0.05;
/// What a browser offers the program; see modules/viewer/README.md.
const messageRates = [0, 1, 2, 5, 10, 30];

class Pace {
  /// `isDear`: whether drawing takes the processor; otherwise the page is drawn as often as the screen.
  constructor(isDear) {
    // What comes first is shown at once.
    Object.assign(this, {isDear, cost: 60, touched: performance.now() - 1000, last: -Infinity, rate: 30, wake: () => {}});
  }
  /// Somebody turns, moves or presses something: for a while everything follows at once.
  touch() {
    this.touched = performance.now();
    this.wake();
  }
  isCalm() { return this.isDear && performance.now() > this.touched + 2000; }
  /// Times from one drawing to the next [ms]: its share of the time, and never less than two drawings per second.
  pause() { return Math.min(500, this.cost / calmShare); }
  /// Tells what a drawing took [ms]. What the browser does with it afterwards is as much again.
  drew(milliseconds) { this.cost += 0.2 * (Math.min(1000, 2 * milliseconds) - this.cost); }
  /// Times between what changes the page around the map, which the browser lays out anew each time [ms].
  panelPause() { return this.isCalm() ? 1000 : 150; }
  /// The number of messages per second that can be shown; none while the page is in a tab behind another.
  messageRate() {
    if (document.hidden) return 0;
    if (!this.isCalm()) return messageRates.at(-1);
    return Math.max(1, messageRates.findLast((rate) => rate <= 1050 / this.pause()));
  }
}
