"""A headless Chromium to try pages in, spoken to through its debugging pipe."""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

CHROMIUM: Final = shutil.which("chromium") or shutil.which("google-chrome")

OPTIONS: Final = (
    "--headless=new --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader "
    "--ignore-gpu-blocklist --proxy-server=127.0.0.1:9 --remote-debugging-pipe "
    "--disable-dev-shm-usage --no-first-run --disable-extensions"
)
"""Software rendering, and a proxy that does not exist: nothing can be fetched."""

SECONDS: Final = 60.0
"""How long an answer may take."""


class Page:
    """A page that is open: `run` evaluates JavaScript in it; `told` is what its console said."""

    def __init__(self, write: int, read: int) -> None:
        self._write, self._read = write, read
        self._rest = b""
        self._count = 0
        self._session = ""
        self.told: list[str] = []
        self._loaded = False

    def open(self, path: Path, wide: int, high: int, *, anchor: str = "") -> None:
        """Open a file in a window of so many pixels, and wait until it is loaded."""
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        attached = self.ask("Target.attachToTarget", targetId=target, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.ask(f"{domain}.enable")
        self.size(wide, high)
        self._loaded = False
        self.ask("Page.navigate", url=path.resolve().as_uri() + anchor)
        end = time.monotonic() + SECONDS
        while not self._loaded:
            self._take(self._message(end))

    def size(self, wide: int, high: int) -> None:
        """Make the window so many pixels wide and high; narrow ones are those of phones."""
        phone = wide < 600
        self.ask(
            "Emulation.setDeviceMetricsOverride",
            width=wide,
            height=high,
            deviceScaleFactor=2 if phone else 1,
            mobile=phone,
        )

    def ask(self, method: str, **params: Any) -> dict[str, Any]:
        """The answer to a command of the protocol."""
        self._count += 1
        message: dict[str, Any] = {"id": self._count, "method": method, "params": params}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + SECONDS
        while True:
            found = self._message(end)
            if found.get("id") == self._count:
                if "error" in found:
                    raise RuntimeError(f"{method}: {found['error']['message']}")
                result: dict[str, Any] = found["result"]
                return result
            self._take(found)

    def run(self, script: str) -> Any:
        """The value of an expression; a promise is waited for."""
        found = self.ask(
            "Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True
        )
        if "exceptionDetails" in found:
            raise RuntimeError(str(found["exceptionDetails"]))
        return found["result"].get("value")

    def wait(self, script: str) -> Any:
        """The value of an expression as soon as it is true."""
        end = time.monotonic() + SECONDS
        while time.monotonic() < end:
            if value := self.run(script):
                return value
            time.sleep(0.02)
        raise TimeoutError(f"{script} did not become true; the console said: {self.told}")

    def click(self, x: float, y: float) -> None:
        """Press and release the left button of the mouse."""
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            button = "none" if kind == "mouseMoved" else "left"
            self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, clickCount=1)

    def key(self, name: str, text: str = "") -> None:
        """Press and release a key."""
        extra = {"text": text} if text else {}
        code = {"Tab": 9, "Enter": 13, " ": 32}.get(name, 0)
        for kind in ("keyDown", "keyUp"):
            self.ask(
                "Input.dispatchKeyEvent",
                type=kind,
                key=name,
                windowsVirtualKeyCode=code,
                **(extra if kind == "keyDown" else {}),
            )

    def picture(self, path: Path) -> None:
        """Save what the window shows as PNG."""
        path.write_bytes(base64.b64decode(self.ask("Page.captureScreenshot")["data"]))

    def pdf(self, path: Path) -> None:
        """Print the page to PDF, in the size that the page asks for."""
        found = self.ask("Page.printToPDF", preferCSSPageSize=True, printBackground=True)
        path.write_bytes(base64.b64decode(found["data"]))

    def _take(self, message: dict[str, Any]) -> None:
        """Note what the page says between answers."""
        method, params = message.get("method", ""), message.get("params", {})
        if method == "Page.loadEventFired":
            self._loaded = True
        elif method == "Runtime.consoleAPICalled":
            self.told.append(f"{params['type']}: {[a.get('value') for a in params['args']]}")
        elif method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.told.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Log.entryAdded":
            # What the renderer in software says of its own speed is not the page's.
            text = params["entry"]["text"]
            if "GPU stall due to ReadPixels" not in text:
                self.told.append(text)
        elif method == "Network.requestWillBeSent":
            url = params["request"]["url"]
            if not url.startswith(("file:", "data:", "blob:")):
                self.told.append(f"asked for {url}")

    def _message(self, end: float) -> dict[str, Any]:
        while b"\0" not in self._rest:
            ready, _, _ = select.select([self._read], [], [], max(0.0, end - time.monotonic()))
            if not ready:
                raise TimeoutError(f"the browser does not answer; the console said: {self.told}")
            data = os.read(self._read, 1 << 20)
            if not data:
                raise RuntimeError("the browser ended")
            self._rest += data
        first, self._rest = self._rest.split(b"\0", 1)
        message: dict[str, Any] = json.loads(first)
        return message


@contextmanager
def page(
    profile: Path, path: Path, wide: int = 1280, high: int = 900, *, anchor: str = ""
) -> Iterator[Page]:
    """A file open in a browser of its own, which ends with the block."""
    assert CHROMIUM is not None
    ask_read, ask_write = os.pipe()
    tell_read, tell_write = os.pipe()

    def ends() -> None:  # the browser reads descriptor 3 and writes descriptor 4
        kept = os.dup(ask_read), os.dup(tell_write)
        os.dup2(kept[0], 3)
        os.dup2(kept[1], 4)

    process = subprocess.Popen(
        [CHROMIUM, *OPTIONS.split(), f"--user-data-dir={profile}"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        close_fds=False,
        preexec_fn=ends,
    )
    os.close(ask_read)
    os.close(tell_write)
    try:
        found = Page(ask_write, tell_read)
        found.open(path, wide, high, anchor=anchor)
        yield found
    finally:
        process.kill()
        process.wait()
        os.close(ask_write)
        os.close(tell_read)
