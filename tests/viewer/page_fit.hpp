// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "support/browser.hpp"

namespace holdfast::test {

/// Waits until an expression holds in the page, a minute at most.
inline bool becomes(Browser& browser, const std::string& expression) {
  for (int i = 0; i < 1200; ++i) {
    if (browser.evaluate("Boolean(" + expression + ")") == true) return true;
    usleep(50'000);
  }
  return false;
}

/// What is wider than the window, by element with its edges and its text; nothing if all fits. What scrolls or is cut
/// in a box of its own does not count, but that the page itself cuts does.
inline const std::string too_wide =
    "(() => { const found = []; const page = document.documentElement;"
    "if (page.scrollWidth > innerWidth) found.push('page: ' + page.scrollWidth + ' px');"
    "for (const e of document.body.querySelectorAll('*')) {"
    "  const box = e.getBoundingClientRect();"
    "  if (!e.getClientRects().length || (box.right <= innerWidth + 1 && box.left >= -1)) continue;"
    "  let outer = e.parentElement;"
    "  while (outer !== document.body && getComputedStyle(outer).overflowX === 'visible') outer = outer.parentElement;"
    "  if (outer !== document.body) continue;"
    "  found.push(`${e.tagName}#${e.id}.${e.className} ${Math.round(box.left)} to ${Math.round(box.right)} px "
    "'${(e.textContent "
    "|| '').slice(0, 50)}'`); }"
    "return found.slice(0, 6).join('; '); })()";

/// Controls that lie on each other.
inline const std::string overlaps =
    "(() => { const boxes = [...document.querySelectorAll('header > *, footer > *, footer button, footer select, "
    "#slider')].filter((e) => e.getClientRects().length && !e.querySelector('button, select, input'));"
    "const names = []; boxes.forEach((a, i) => boxes.slice(i + 1).forEach((b) => { const p = "
    "a.getBoundingClientRect(), q = b.getBoundingClientRect();"
    "if (Math.min(p.right, q.right) - Math.max(p.left, q.left) > 1 && Math.min(p.bottom, q.bottom) - Math.max(p.top, "
    "q.top) > 1) names.push(a.id + a.className + ' on ' + b.id + b.className); })); return names.join(', '); })()";

/// Nothing is wider than the window, and no control lies on another, from a large screen to a phone, dark and light.
inline void expect_it_fits(Browser& browser) {
  for (const int width : {1300, 800, 400})
    for (const bool is_dark : {false, true}) {
      browser.show_at(width, 800, is_dark);
      const std::string state =
          browser
              .evaluate("(document.getElementById('state')?.textContent ?? 'report') + ' in a window of ' + innerWidth")
              .get<std::string>();
      EXPECT_TRUE(becomes(browser, "innerWidth === " + std::to_string(width) + " && " + too_wide + " === ''"))
          << width << " px, " << state << ": " << browser.evaluate(too_wide);
      EXPECT_EQ(browser.evaluate(overlaps), "") << width << " px, " << state;
      // All pages have the colours of one style sheet.
      EXPECT_EQ(browser.evaluate("getComputedStyle(document.documentElement).getPropertyValue('--ground').trim()"),
                is_dark ? "#14171b" : "#ffffff");
    }
}

}  // namespace holdfast::test
