#!/usr/bin/env python3
"""The reports in a browser: they load without a complaint, sliders and drags change what is seen, plots have axes and
tell what is under the pointer, nothing is wider than a telephone. Pictures of all are left in the folder named last.

    reports_test.py HDR_BINARY OUTPUT_FOLDER
"""
import os
import subprocess
import sys

import chromium

kSkipped = 77
failures = []


def check(condition, words):
    print(("ok      " if condition else "FAILED  ") + words)
    if not condition:
        failures.append(words)


def hdr(binary, *arguments):
    subprocess.run([binary, *arguments, "--quiet"], check=True)


def make_reports(binary, folder):
    at = lambda name: os.path.join(folder, name)
    hdr(binary, "simulate", "--test-chart", "-o", at("world.exr"))
    hdr(binary, "simulate", at("world.exr"), "--ball", "--size", "400x300", "--times", "1/1000,1/250,1/60,1/40,1/15,1/4",
        "--shift", "2", "-o", at("shots"))
    hdr(binary, "calibrate", at("shots"), "-o", at("response.json"), "--report", at("calibrate.html"))
    hdr(binary, "merge", at("shots"), "-o", at("map.exr"), "--report", at("merge.html"))
    hdr(binary, "probe", at("shots"), "-o", at("probe.exr"), "--width", "256", "--report", at("probe.html"))
    hdr(binary, "render", "--probe", at("probe.exr"), "-o", at("render.exr"), "--size", "160x120", "--samples", "8",
        "--report", at("render.html"))
    hdr(binary, "bench", "sh", "lights", "skips", "--quick", "-o", at("bench.html"))


def check_page(browser, folder, name, width):
    browser.open(os.path.join(folder, name + ".html"), width)
    browser.wait("[...document.querySelectorAll('.picture, .viewer')].every((e) => e.dataset.ready)")
    here = "%s at %d px: " % (name, width)
    check(browser.value("[...document.querySelectorAll('.picture, .viewer')].every((e) => e.dataset.ready === 'yes')"),
          here + "pictures are there")
    wide = browser.value("document.documentElement.scrollWidth")
    check(wide <= width, here + "nothing reaches over the edge (%d px)" % wide)
    small = browser.value(
        "Math.min(99, ...[...document.querySelectorAll('svg.plot text')].map((t) => t.getBoundingClientRect().height))")
    check(small >= 9, here + "no text of a plot is smaller than 9 px (%.1f)" % small)
    # Tick labels of one axis must not run into each other.
    overlaps = browser.value("""(() => { let count = 0;
      for (const axis of document.querySelectorAll('svg.plot .axis')) {
        const boxes = [...axis.querySelectorAll('text:not(.label)')].map((t) => t.getBoundingClientRect());
        for (let a = 0; a < boxes.length; ++a) for (let b = a + 1; b < boxes.length; ++b) {
          const p = boxes[a], q = boxes[b];
          if (p.left < q.right - 1 && q.left < p.right - 1 && p.top < q.bottom - 3 && q.top < p.bottom - 3) ++count;
        } }
      return count; })()""")
    check(overlaps == 0, here + "numbers of an axis stand apart (%d do not)" % overlaps)
    plots = browser.value("""[...document.querySelectorAll('svg.plot')].map((s) =>
        [s.getAttribute('aria-label'), s.querySelectorAll('.axis').length,
         [...s.querySelectorAll('.axis')].every((a) => a.querySelector('text')),
         [...s.querySelectorAll('text.label')].every((l) => l.textContent.length > 0)])""")
    for title, axes, marked, named in plots:
        if not (axes == 2 and marked and named):
            check(False, here + "the plot '%s' has two axes with numbers and names" % title)
    complaints = browser.complaints()
    check(not complaints, here + "no complaint" + "".join("\n        " + c for c in complaints))
    browser.screenshot(os.path.join(folder, "%s-%d.png" % (name, width)))


def move_slider(browser, selector, share):
    left, top, width, height = browser.place(selector)
    at = lambda s: (left + 8 + s * (width - 16), top + height / 2)
    browser.drag(at(0.5), at(share))


def check_picture(browser, folder):
    browser.open(os.path.join(folder, "merge.html"), 1280)
    browser.wait("document.querySelector('.picture').dataset.ready === 'yes'")
    before = browser.picture(".picture canvas")
    move_slider(browser, ".picture .exposure", 0.7)
    after = browser.picture(".picture canvas")
    check(chromium.mean(after) > chromium.mean(before) + 5,
          "map: more exposure is brighter (%.0f, was %.0f)" % (chromium.mean(after), chromium.mean(before)))
    move_slider(browser, ".picture .exposure", 0.3)
    darker = browser.picture(".picture canvas")
    check(chromium.mean(darker) < chromium.mean(after) - 5, "map: less is darker (%.0f)" % chromium.mean(darker))
    browser.value("(() => { const t = document.querySelector('.picture .tone'); t.value = 'false'; "
                  "t.dispatchEvent(new Event('input', {bubbles: true})); })()")
    check(chromium.changed(darker, browser.picture(".picture canvas")) > 0.5, "map: stops as colours are others")
    left, top, width, height = browser.place(".picture canvas")
    browser.mouse("mouseMoved", left + width / 2, top + height / 2)
    text = browser.value("document.querySelector('.picture .readout').textContent")
    check(text.startswith("radiance "), "map: it says what is under the pointer: " + text)


def check_viewer(browser, folder):
    browser.open(os.path.join(folder, "probe.html"), 1280)
    browser.wait("document.querySelector('.viewer').dataset.ready === 'yes'")
    seen = []
    for view, name in (("2", "objects"), ("0", "inside"), ("1", "outside")):
        browser.value("(() => { const v = document.querySelector('.viewer .view'); v.value = '%s'; "
                      "v.dispatchEvent(new Event('input', {bubbles: true})); })()" % view)
        before = browser.picture(".viewer canvas")
        seen.append(before)
        check(max(before[2]) > 60, "probe, %s: something is seen" % name)
        left, top, width, height = browser.place(".viewer canvas")
        middle = (left + width / 2, top + height / 2)
        browser.drag(middle, (middle[0] + width / 5, middle[1] + height / 10))
        after = browser.picture(".viewer canvas")
        share = chromium.changed(before, after)
        check(share > 0.02, "probe, %s: a drag turns it (%.0f %% of the samples change)" % (name, 100 * share))
    check(all(chromium.changed(seen[k], seen[k - 1]) > 0.1 for k in range(3)), "probe: three views differ")
    for slider, words in (("exposure", "brighter"), ("glare", "with more glare")):
        before = browser.picture(".viewer canvas")
        move_slider(browser, ".viewer ." + slider, 0.9)
        after = browser.picture(".viewer canvas")
        check(chromium.mean(after) > chromium.mean(before), "probe: it becomes %s (%.1f, was %.1f)" %
              (words, chromium.mean(after), chromium.mean(before)))
    check(not browser.complaints(), "probe: no complaint while it was turned")


def check_plot(browser, folder):
    browser.open(os.path.join(folder, "bench.html"), 1280)
    left, top, width, height = browser.place("svg.plot")
    browser.mouse("mouseMoved", left + 0.6 * width, top + 0.4 * height)
    text = browser.value("document.querySelector('svg.plot').parentNode.querySelector('.readout').textContent")
    check("(" in text, "bench: a plot says what is under the pointer: " + text)
    browser.value("document.querySelector('details').open = true")
    rows = browser.value("document.querySelector('details').querySelectorAll('tr').length")
    check(rows > 10, "bench: all rows can be read (%d)" % rows)


def main(binary, folder):
    program = chromium.find()
    if not program:
        print("skipped: no Chromium here; apt-get install chromium")
        return kSkipped
    os.makedirs(folder, exist_ok=True)
    subprocess.run(["rm", "-rf", os.path.join(folder, "shots")], check=True)
    make_reports(binary, folder)
    try:
        browser = chromium.Chromium(program)
    except RuntimeError as e:
        print("skipped: %s does not start (%s)" % (program, e))
        return kSkipped
    try:
        for name in ("calibrate", "merge", "probe", "render", "bench"):
            for width in (1280, 390):
                check_page(browser, folder, name, width)
        check_picture(browser, folder)
        check_viewer(browser, folder)
        check_plot(browser, folder)
    finally:
        browser.close()
    print("%d failed; pictures in %s" % (len(failures), folder))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
