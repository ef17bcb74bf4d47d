"""Headless Chromium by its DevTools protocol over a pipe: no driver, no library, no port [CDP]."""
import base64
import fcntl
import json
import os
import select
import shutil
import struct
import subprocess
import tempfile
import time
import zlib

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")


def find():
    """The browser's path, or None."""
    return next((path for path in map(shutil.which, PROGRAMS) if path), None)


class Chromium:
    """One browser with one page. `events` are all that it has told."""

    def __init__(self, program):
        self.folder = tempfile.mkdtemp(prefix="hdr-chromium-")
        theirs_in, ours_out = os.pipe()
        ours_in, theirs_out = os.pipe()
        # The browser reads from 3 and writes to 4; numbers above those cannot be overwritten on the way there.
        theirs = [fcntl.fcntl(fd, fcntl.F_DUPFD, 100) for fd in (theirs_in, theirs_out)]

        def place():
            os.dup2(theirs[0], 3)
            os.dup2(theirs[1], 4)

        # Software WebGL: what a machine without a graphics card has, and the same pixels on every one.
        self.process = subprocess.Popen(
            [program, "--headless", "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader",
             "--enable-unsafe-swiftshader", "--hide-scrollbars", "--force-device-scale-factor=1",
             "--remote-debugging-pipe", "--no-first-run", "--user-data-dir=" + self.folder],
            preexec_fn=place, close_fds=False, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL)
        for fd in (theirs_in, theirs_out, *theirs):
            os.close(fd)
        self.ours_in, self.ours_out, self.buffer, self.number = ours_in, ours_out, b"", 0
        self.events, self.session = [], None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(domain + ".enable")

    def close(self):
        try:
            self.session = None
            self.call("Browser.close", seconds=10)
            self.process.wait(10)
        except (RuntimeError, OSError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def receive(self, seconds):
        """The next message; RuntimeError when none comes."""
        end = time.monotonic() + seconds
        while b"\0" not in self.buffer:
            ready, _, _ = select.select([self.ours_in], [], [], max(0, end - time.monotonic()))
            data = os.read(self.ours_in, 1 << 20) if ready else b""
            if not data:
                raise RuntimeError("the browser says nothing")
            self.buffer += data
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, seconds=60, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.ours_out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive(seconds)
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(method + ": " + answer["error"]["message"])
                return answer["result"]
            if "method" in answer:
                self.events.append(answer)

    def value(self, expression):
        """What JavaScript makes of it, promises awaited."""
        result = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            raise RuntimeError(expression + ": " + json.dumps(result["exceptionDetails"].get("exception", {})))
        return result["result"].get("value")

    def wait(self, expression, seconds=60):
        end = time.monotonic() + seconds
        while not self.value(expression):
            if time.monotonic() > end:
                raise RuntimeError("does not become true: " + expression)
            time.sleep(0.05)

    def open(self, path, width, height=900):
        self.events.clear()
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1,
                  mobile=width < 600)
        self.call("Page.navigate", url="file://" + os.path.abspath(path))
        self.wait("document.readyState === 'complete'")

    def complaints(self):
        """Errors of the console, exceptions, and whatever was asked of the network."""
        self.value("new Promise((done) => requestAnimationFrame(() => setTimeout(done, 50)))")
        found = []
        for event in self.events:
            method, parameters = event["method"], event["params"]
            if method == "Runtime.exceptionThrown":
                found.append(json.dumps(parameters["exceptionDetails"]))
            elif method == "Log.entryAdded" and parameters["entry"]["level"] in ("error", "warning"):
                # Of a driver in software, when a screenshot is taken: no fault of the page.
                if "GL Driver Message (OpenGL, Performance" not in parameters["entry"]["text"]:
                    found.append(parameters["entry"]["text"])
            elif method == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "warning", "assert"):
                found.append(json.dumps(parameters["args"]))
            elif method == "Network.requestWillBeSent":
                url = parameters["request"]["url"]
                if not url.startswith(("file:", "data:", "blob:")):
                    found.append("asks the network for " + url)
        return found

    # What a hand does. Places are in the window.
    def mouse(self, kind, x, y, held=False):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left" if held else "none",
                  buttons=1 if held and kind != "mouseReleased" else 0, clickCount=1 if held else 0)

    def drag(self, start, end, steps=8):
        self.mouse("mouseMoved", *start)
        self.mouse("mousePressed", *start, held=True)
        for k in range(1, steps + 1):
            self.mouse("mouseMoved", *(a + (b - a) * k / steps for a, b in zip(start, end)), held=True)
        self.mouse("mouseReleased", *end, held=True)

    def place(self, selector):
        """[left, top, width, height] in the window, scrolled to its middle."""
        return self.value("(() => { const e = document.querySelector(%s); e.scrollIntoView({block: 'center', "
                          "behavior: 'instant'}); const b = e.getBoundingClientRect(); "
                          "return [b.left, b.top, b.width, b.height]; })()" % json.dumps(selector))

    def picture(self, selector):
        """What is on the screen there: (width, height, bytes of RGB)."""
        left, top, width, height = self.place(selector)
        scroll = self.value("[scrollX, scrollY]")
        self.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        shot = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=True,
                         clip={"x": left + scroll[0], "y": top + scroll[1], "width": width, "height": height,
                               "scale": 1})
        return rgb_of_png(base64.b64decode(shot["data"]))

    def screenshot(self, path, tallest=16000):
        """The whole page."""
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        shot = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=True,
                         clip={"x": 0, "y": 0, "width": size["width"], "height": min(size["height"], tallest),
                               "scale": 1})
        with open(path, "wb") as file:
            file.write(base64.b64decode(shot["data"]))


def rgb_of_png(data):
    """(width, height, bytes of RGB) of an 8-bit PNG with or without alpha [PNG]."""
    at, packed, width, height, channels = 8, b"", 0, 0, 3
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
            assert depth == 8 and colour in (2, 6), "a PNG of another kind"
            channels = 4 if colour == 6 else 3
        if kind == b"IDAT":
            packed += body
        at += 12 + length
    raw, stride, before, out = zlib.decompress(packed), width * channels, bytearray(width * channels), bytearray()
    for y in range(height):
        line = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        unfilter(raw[y * (stride + 1)], line, before, channels)
        for c in range(0, stride, channels):
            out += line[c:c + 3]
        before = line
    return width, height, bytes(out)


def unfilter(kind, line, before, channels):
    for k in range(len(line)) if kind else ():
        left = line[k - channels] if k >= channels else 0
        corner = before[k - channels] if k >= channels else 0
        if kind == 1:
            guess = left
        elif kind == 2:
            guess = before[k]
        elif kind == 3:
            guess = (left + before[k]) // 2
        else:
            far = [abs(before[k] - corner), abs(left - corner), abs(left + before[k] - 2 * corner)]
            guess = left if far[0] <= far[1] and far[0] <= far[2] else before[k] if far[1] <= far[2] else corner
        line[k] = (line[k] + guess) & 255


def mean(picture):
    return sum(picture[2]) / len(picture[2])


def changed(a, b):
    """Share of the samples that differ by more than rounding."""
    if a[:2] != b[:2]:
        return 1.0
    return sum(abs(p - q) > 2 for p, q in zip(a[2], b[2])) / len(a[2])
