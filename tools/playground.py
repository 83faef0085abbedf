#!/usr/bin/env python3
"""Writes the playground: one page with the command for WebAssembly and the models of programs/ in it.

    tools/playground.py --wasm build/wasm/fp3.wasm --output build/playground/index.html
"""

import argparse
import base64
import gzip
import json
import os
import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGE, VIEW = ROOT / "sw/playground", ROOT / "sw/view/page"


def models():
    return {path.stem: path.read_text(encoding="utf-8") for path in sorted((ROOT / "programs").glob("*.ode"))}


def integrators():
    return sorted(path.stem for path in (ROOT / "programs/integrators").glob("*.cfg"))


def page(wasm):
    """No text in it may end a script: JSON writes each < in another way, and base64 has none."""
    text = {path.name: path.read_text(encoding="utf-8") for path in PAGE.iterdir()}
    about = json.dumps({"models": models(), "integrators": integrators()}).replace("<", "\\u003c")
    packed = base64.b64encode(gzip.compress(wasm, 9, mtime=0)).decode()
    style = (VIEW / "style.css").read_text(encoding="utf-8") + text["style.css"]
    worker, script = text["wasi.js"] + text["worker.js"], text["plot.js"] + text["app.js"]
    return (f"{text['head.html']}<style>\n{style}</style>\n{text['body.html']}"
            f'<script type="application/json" id="about">{about}</script>\n<script type="text/plain" id="wasm">{packed}</script>\n'
            f'<script type="text/plain" id="code">"use strict";\n{worker}</script>\n<script>\n"use strict";\n{script}</script>\n</body>\n</html>\n')


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--wasm", type=pathlib.Path, default=ROOT / "build/wasm/fp3.wasm")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build/playground/index.html")
    options = parser.parse_args()
    made = page(options.wasm.read_bytes())
    options.output.parent.mkdir(parents=True, exist_ok=True)
    temporary = options.output.with_name(f"{options.output.name}.{os.getpid()}")
    temporary.write_text(made, encoding="utf-8")
    os.replace(temporary, options.output)


if __name__ == "__main__":
    main()
