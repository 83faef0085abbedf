"""The scene of memory.c: what memory has to be, and a C header that says where everything is in it.

    row = memory_data.make(alone, folder, scene, steps, roam, at, end)     of build/bench/alone
"""

import json
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONFIG = "world_memory"
SCENE = ROOT / "programs/gallery/flag.scene"
MEASURED = 8192                            # words that memory.c moves to see how fast memory is; FP3's store has room for them


def words_of(image):
    """The words of a file, low byte first."""
    whole = image.read_bytes()
    return [int.from_bytes(whole[i:i + 4], "little") for i in range(0, len(whole), 4)]


def header_of(row, end):
    free = -(-(row["at"] + 4 * row["words"]) // 4096) * 4096
    if free + 4 * MEASURED > end:
        raise ValueError(f"{row['words']} words of '{row['scene']}' and {MEASURED} more have no room below 0x{end:08x}")
    runs = "".join(f"    {{0x{before:08x}u, 0x{after:08x}u, {count}}},\n" for before, after, count in row["runs"])
    return f"""/* Where everything is in memory; written by memory_data.py. */
#define SCENE_NAME "{pathlib.Path(row["scene"]).stem}"
#define SCENE_OBJECTS {row["objects"]}u
#define SCENE_AT 0x{row["at"]:08x}u
#define SCENE_LIST 0x{row["list"]:08x}u
#define SCENE_FREE 0x{free:08x}u /* nothing is from here on */
#define SCENE_END 0x{end:08x}u  /* no memory is from here on */
#define SCENE_MEASURED {MEASURED}u /* words that are moved for their time */
/* Words that steps store: where they begin before and after the steps, and how many an object has. */
static const struct {{
    uint32_t before, after, count;
}} scene_runs[] = {{
{runs}}};
/* Of each object, where it is within them. */
static const uint32_t scene_places[] = {{{", ".join(map(str, row["places"]))}}};
"""


def make(alone, folder, scene, steps, roam, at, end):
    """memory.image and memory_data.h in a folder. roam: how far near objects may go; None: there are none. The row has the hashes before and after the steps, by the engine fast."""
    image = folder / "memory.image"
    done = subprocess.run([alone, "image", CONFIG, scene, str(steps), str(at), image, *([] if roam is None else [str(roam)])], capture_output=True, text=True)
    if done.returncode:
        raise ValueError(done.stderr.strip())
    row = json.loads(done.stdout)
    (folder / "memory_data.h").write_text(header_of(row, end))
    return row
