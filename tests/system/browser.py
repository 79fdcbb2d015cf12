"""Chromium without a window, driven through the pipe of its DevTools protocol: no driver, no further package."""

import base64
import json
import os
import subprocess
from contextlib import suppress

from tests.waiting import wait_until

FLAGS = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run"),
    *("--remote-debugging-pipe", "--disable-background-networking", "--disable-component-update", "--hide-scrollbars"),
)


class Browser:
    """A browser with one page; `problems` is what the page complained of: errors of scripts and refused requests."""

    def __init__(self, folder):
        self._number = 0
        self.problems = []
        ours, theirs = os.pipe(), os.pipe()
        self._write, self._read = os.fdopen(ours[1], "wb", buffering=0), os.fdopen(theirs[0], "rb")
        # The browser reads from 3 and writes to 4.
        script = f'exec chromium "$@" 3<&{ours[0]} 4>&{theirs[1]}'
        self._process = subprocess.Popen(
            ["bash", "-c", script, "chromium", *FLAGS, f"--user-data-dir={folder}"],
            pass_fds=(ours[0], theirs[1]),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(ours[0])
        os.close(theirs[1])
        self._unread = b""
        self._session = None
        target = self.do("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.do("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for part in ("Page", "Runtime", "Log", "Network", "Accessibility"):
            self.do(f"{part}.enable")

    def close(self):
        with suppress(OSError):
            self.do("Browser.close")
        self._process.kill()
        self._process.wait()
        self._write.close()
        self._read.close()

    def do(self, method, **parameters):
        """Have something done; return the result."""
        self._number += 1
        order = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            order["sessionId"] = self._session
        self._write.write(json.dumps(order).encode() + b"\0")
        while True:
            told = self._next()
            if told.get("id") == self._number:
                assert "error" not in told, f"{method}: {told['error']}"
                return told["result"]
            self._note(told)

    def open(self, url, *, width=1280, height=900, dark=False):
        """Open a page anew at this size."""
        self.do("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.do("Emulation.setEmulatedMedia", features=[scheme])
        self.do("Page.navigate", url="about:blank")  # else an address with another fragment loads nothing
        self.do("Page.navigate", url=url)
        self.wait("document.readyState === 'complete'", "the page")

    def run(self, script):
        """Return the value of an expression in the page."""
        told = self.do("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in told, f"{script}: {told['exceptionDetails']}"
        return told["result"].get("value")

    def wait(self, script, what):
        """Wait until an expression is true."""
        wait_until(lambda: self.run(f"Boolean({script})"), what=what)

    def click(self, selector):
        """Click in the middle of an element, as a mouse does."""
        self.run(f"document.querySelector({selector!r}).scrollIntoView({{block: 'center', behavior: 'instant'}})")
        middle = "(r => [r.x + r.width / 2, r.y + r.height / 2])"
        x, y = self.run(f"{middle}(document.querySelector({selector!r}).getBoundingClientRect())")
        for kind in ("mousePressed", "mouseReleased"):
            self.do("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def press(self, key, *, code=0, text=""):
        """Press a key."""
        more = {"text": text} if text else {}
        self.do("Input.dispatchKeyEvent", type="keyDown", key=key, windowsVirtualKeyCode=code, **more)
        self.do("Input.dispatchKeyEvent", type="keyUp", key=key, windowsVirtualKeyCode=code)

    def spoken(self):
        """Return what a screen reader is told: role and name of everything that is not ignored."""
        nodes = self.do("Accessibility.getFullAXTree")["nodes"]
        return [
            (node["role"]["value"], node.get("name", {}).get("value", "")) for node in nodes if not node.get("ignored")
        ]

    def picture(self, file):
        """Write what is seen, all of the page."""
        data = self.do("Page.captureScreenshot", format="png", captureBeyondViewport=True)["data"]
        file.write_bytes(base64.b64decode(data))

    def _next(self):
        while b"\0" not in self._unread:
            part = os.read(self._read.fileno(), 1 << 20)
            assert part, "the browser ended"
            self._unread += part
        told, _, self._unread = self._unread.partition(b"\0")
        return json.loads(told)

    def _note(self, told):
        method, said = told.get("method"), told.get("params", {})
        if method == "Runtime.exceptionThrown":
            self.problems.append(said["exceptionDetails"]["exception"].get("description", "an exception"))
        elif method == "Log.entryAdded" and said["entry"]["level"] == "error":
            self.problems.append(f"{said['entry']['text']} {said['entry'].get('url', '')}")
        elif method == "Network.requestWillBeSent":
            url = said["request"]["url"]
            if not url.startswith(("http://127.0.0.1:", "blob:", "data:", "about:")):
                self.problems.append(f"asks {url}")
