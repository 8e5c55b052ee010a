"""Runs a planner of a user for the program skycap (missions/session/python_planner.h).

A command is its length (8 bytes), a JSON object, and the arrays of a scan. Answers are JSON objects.
Output of the planner goes to the error stream.
"""
import importlib.util, inspect, json, math, os, signal, struct, sys, time, traceback
from types import SimpleNamespace

try:
    import numpy as np
except ImportError:
    np = None

signal.signal(signal.SIGINT, signal.SIG_IGN)
commands = os.fdopen(os.dup(0), "rb")
answers = os.fdopen(os.dup(1), "wb")
os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
os.dup2(2, 1)


def answer(**message):
    text = json.dumps(message).encode()
    answers.write(struct.pack("<Q", len(text)) + text)
    answers.flush()


def read(size):
    data = commands.read(size)
    if len(data) != size:
        sys.exit(0)
    return data


def command():
    return json.loads(read(struct.unpack("<Q", read(8))[0]))


def load(file):
    spec = importlib.util.spec_from_file_location("skycap_own_planner", file)
    module = importlib.util.module_from_spec(spec)
    sys.path.insert(0, os.path.dirname(file))
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    found = [item for item in vars(module).values() if inspect.isclass(item)
             and item.__module__ == spec.name and callable(getattr(item, "next_view", None))]
    if len(found) != 1:
        raise TypeError(f"the file must have one class with a method next_view; it has {len(found)}")
    return found[0]


def read_rows(rows):
    """An array of rows with three numbers; without numpy, a memoryview of the same shape."""
    data = read(12 * rows)
    if np is not None:
        return np.frombuffer(data, "<f4").reshape(-1, 3)
    return memoryview(data).cast("B").cast("f", [rows, 3]) if rows else []


def scan_of(message):
    points = read_rows(message["points"])
    pixels = read(4 * message["pixels"])
    pixels = memoryview(pixels).cast("I") if np is None else np.frombuffer(pixels, "<u4")
    array = list if np is None else np.array
    rotation = message["rotation"]
    return SimpleNamespace(number=message["number"], points=points, pixels=pixels,
                           stored=read_rows(message["stored"]), low=array(message["low"]),
                           high=array(message["high"]), position=array(message["position"]),
                           rotation=array([rotation[:3], rotation[3:6], rotation[6:]]))


def view_of(view):
    if view is None:
        return None
    position, direction = ([float(number) for number in part] for part in view)
    if len(position) != 3 or len(direction) != 3:
        raise TypeError("next_view must return None or a position and a direction with 3 numbers each")
    if not all(math.isfinite(number) for number in position + direction):
        raise ValueError("next_view returned a number that is not finite")
    return position + direction


planner = None
try:
    while True:
        message = command()
        begun = time.process_time()
        if message["command"] == "make":
            planner = load(message["file"])(SimpleNamespace(**message["task"]))
            answer(view=None, seconds=time.process_time() - begun)
        elif message["command"] == "next_view":
            answer(view=view_of(planner.next_view(scan_of(message))),
                   seconds=time.process_time() - begun)
        else:
            other = getattr(planner, "next_alternative_view", lambda: None)
            answer(view=view_of(other()), seconds=time.process_time() - begun)
except Exception as failure:
    frames = [frame for frame in traceback.extract_tb(failure.__traceback__)
              if not frame.filename.startswith("<")]
    line = f" (line {frames[-1].lineno} of {os.path.basename(frames[-1].filename)})" if frames else ""
    answer(error=f"{type(failure).__name__}: {failure}{line}")
