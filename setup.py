"""What pyproject.toml cannot say: make builds the library, it lies within the package, and the wheel is of one platform.

Everything that is written goes below build/python/: build/lib, where setuptools would put the package, is the library's.
"""

import pathlib
import re
import subprocess

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py
from setuptools.command.egg_info import egg_info

try:
    from setuptools.command.bdist_wheel import bdist_wheel
except ImportError:
    from wheel.bdist_wheel import bdist_wheel

ROOT = pathlib.Path(__file__).resolve().parent
WORK = ROOT / "build/python"
VERSION = re.search(r'^#define FP3_VERSION "(.*)"$', (ROOT / "sw/include/fp3/status.h").read_text(), re.M)[1]


class Native(Distribution):
    """A wheel of one platform, for any Python 3: the library is C, and ctypes loads it."""

    def has_ext_modules(self):
        return True


class Build(build_py):
    """What `make install` installs, below fp3/_native/; without headers, manual page and driver."""

    def run(self):
        super().run()
        if getattr(self, "editable_mode", False):
            return  # the package in the sources takes the library from build/
        native = pathlib.Path(self.build_lib).resolve() / "fp3/_native"
        subprocess.run(["make", "-C", str(ROOT), "python-native", f"NATIVE={native}"], check=True)


class Wheel(bdist_wheel):
    def get_tag(self):
        return ("py3", "none", super().get_tag()[2])


class Info(egg_info):
    def initialize_options(self):
        super().initialize_options()
        WORK.mkdir(parents=True, exist_ok=True)
        self.egg_base = str(WORK)


setup(version=VERSION, distclass=Native, cmdclass={"build_py": Build, "bdist_wheel": Wheel, "egg_info": Info},
      options={"build": {"build_base": str(WORK)}, "bdist_wheel": {"bdist_dir": str(WORK / "wheel")}})
