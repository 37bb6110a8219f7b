"""MiniRocket (Dempster, Schmidt and Webb 2021) on the clips and splits of docs/perception.md.

    cargo run --release -p kineme-paper --example recognition_table -- CORPUS --export FOLDER
    python minirocket.py FOLDER > minirocket.csv

Landmarks (or the hands from the middle of the shoulders, turned until the line of the shoulders lies across) at 64 frames,
aeon's MiniRocketClassifier with its defaults, seed 0. Prints a line a row of the tables: name, value, versions and date.
Of an open set: the area under the curve of the largest margin of its linear classifier, and the share of unknown clips
found where 95 % of the known are kept, the limit known in hindsight.
"""

import csv
import datetime
import importlib.metadata
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np
from aeon.classification.convolution_based import MiniRocketClassifier
from sklearn.metrics import roc_auc_score

FRAMES = 64


def read_clips(path):
    """Classes, and landmarks as clips x channels x frames, with the channels' names."""
    with open(path, newline="") as file:
        reader = csv.reader(file)
        header = next(reader)[1:]
        rows = np.array([[float(v) for v in row] for row in reader])
    dims = len(header) // FRAMES
    names = [name.rsplit("_", 1)[0] for name in header[:dims]]
    values = rows[:, 1:].reshape(len(rows), FRAMES, dims).transpose(0, 2, 1)
    return rows[:, 0].astype(int), values, names


def hands(values, names):
    """Both hands from the middle of the shoulders, heading by the line of the shoulders."""

    def point(role):
        return values[:, [names.index(f"{role}_{axis}") for axis in "xyz"]]

    left, right = point("left_upper_arm"), point("right_upper_arm")
    across, middle = left - right, 0.5 * (left + right)
    heading = np.arctan2(-across[:, 0], across[:, 1])
    cos, sin = np.cos(heading), np.sin(heading)
    channels = []
    for role in ("left_hand", "right_hand"):
        x, y, z = np.moveaxis(point(role) - middle, 1, 0)
        channels += [cos * x + sin * y, cos * y - sin * x, z]
    return np.stack(channels, axis=1)


def margins(classifier, values):
    """The largest margin of each clip over the classes."""
    decision = classifier.pipeline_.decision_function(values)
    return np.abs(decision) if decision.ndim == 1 else decision.max(axis=1)


def found(known, novelty):
    """The share of unknown clips beyond the least limit that keeps 95 % of the known ones."""
    kept = np.sort(novelty[known])
    limit = kept[int(np.ceil(0.95 * len(kept))) - 1]
    return np.mean(novelty[~known] > limit)


def main(folder):
    sets, measures = {}, defaultdict(list)
    csv.field_size_limit(10**9)
    with open(folder / "rows.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        number = row["set"]
        if number not in sets:
            sets[number] = read_clips(folder / f"clips-{number}.csv")
        labels, values, names = sets[number]
        if row["features"] == "hands":
            values = hands(values, names)
        train, test = ([int(i) for i in row[part].split()] for part in ("train", "test"))
        classifier = MiniRocketClassifier(random_state=0)
        classifier.fit(values[train], labels[train])
        if row["open"] == "true":
            known = np.isin(labels[test], labels[train])
            novelty = -margins(classifier, values[test])
            measures[f"{row['row']}, AUROC"].append(roc_auc_score(~known, novelty))
            measures[f"{row['row']}, found"].append(found(known, novelty))
        else:
            measures[row["row"]].extend(classifier.predict(values[test]) == labels[test])
        print(row["row"], file=sys.stderr)
    versions = ", ".join(
        f"{name} {importlib.metadata.version(name)}" for name in ("aeon", "scikit-learn", "numpy")
    )
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(["row", "value", "made_by"])
    for name, values in measures.items():
        made_by = f"{versions}, {datetime.date.today().isoformat()}"
        writer.writerow([name, f"{np.mean(values):.3f}", made_by])


if __name__ == "__main__":
    main(Path(sys.argv[1]))
