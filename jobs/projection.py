"""From runs in which everything is exact to rank counts where only a sample of slabs is: what phases take and
send there, by how each is known to grow.

Every quantity is a sum of what is known (the traffic of finding borders, the points that change ranks) and of
terms that grow in a known way, with factors that are fitted to the exact runs of the same distribution and
points per rank; none of them may be negative.
"""
import math

PHASES = ("sort", "split", "triangulate", "stitch")


def log2_ceiling(ranks):
    return (ranks - 1).bit_length()


class Network:
    """As tests/benchmark/virtual/network.hpp."""

    def __init__(self, parameters):
        self.latency = parameters["latency_s"]
        self.overhead = parameters["overhead_s"]
        self.bandwidth = parameters["bytes_per_second"]

    def message(self, size):
        return self.latency + 2 * self.overhead + size / self.bandwidth

    def all_reduce(self, ranks, size):
        return log2_ceiling(ranks) * self.message(size)

    def all_to_all(self, ranks, size):
        return self.latency + (ranks - 1) * (2 * self.overhead + size / self.bandwidth)


def solve(matrix, values):
    """Gauss with pivoting."""
    rows = [list(row) + [value] for row, value in zip(matrix, values)]
    n = len(rows)
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: abs(rows[r][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        if rows[i][i] == 0:
            return None
        for r in range(i + 1, n):
            factor = rows[r][i] / rows[i][i]
            rows[r] = [a - factor * b for a, b in zip(rows[r], rows[i])]
    result = [0.0] * n
    for i in reversed(range(n)):
        result[i] = (rows[i][n] - sum(rows[i][j] * result[j] for j in range(i + 1, n))) / rows[i][i]
    return result


def fit(features, values, scales):
    """Factors, none negative, that make the features add up to the values, with the least squares of errors in units
    of the scales."""
    weights = [1 / scale if scale > 0 else 1.0 for scale in scales]
    kept = list(range(len(features[0])))
    while kept:
        scaled = [[row[k] * weight for k in kept] for row, weight in zip(features, weights)]
        targets = [value * weight for value, weight in zip(values, weights)]
        normal = [[sum(row[i] * row[j] for row in scaled) for j in range(len(kept))] for i in range(len(kept))]
        right = [sum(row[i] * target for row, target in zip(scaled, targets)) for i in range(len(kept))]
        factors = solve(normal, right)
        if factors is None:  # fewer runs than terms
            kept.pop()
        elif min(factors) < 0:
            kept.remove(kept[factors.index(min(factors))])
        else:
            return {k: factor for k, factor in zip(kept, factors)}
    return {}


def border_rounds(record):
    """How often all ranks counted what is before the borders: all-reduces by the messages of the sort, apart from
    those of each rank to every other (four exchanges, of counts and of columns) and from the rest (about 25)."""
    ranks = record["ranks"]
    messages = phase(record, "sort")["messages_sent"] / ranks
    return max(0.0, (messages - 4 * (ranks - 1)) / log2_ceiling(ranks) - 25)


def phase(record, name):
    return next(p for p in record["phases"] if p["name"] == name)


class Growth:
    """Of one phase and quantity: what is known, and the terms of the rest; functions of a record."""

    def __init__(self, known, *terms):
        self.known = known
        self.terms = terms

    def carry_on(self, exact, quantity, record):
        quantities = [quantity(run) for run in exact]
        rest = [value - self.known(run) for value, run in zip(quantities, exact)]
        factors = fit([[term(run) for term in self.terms] for run in exact], rest, quantities)
        return self.known(record) + sum(factor * self.terms[k](record) for k, factor in factors.items())


def growths(rounds, network):
    """By phase: seconds on the slowest rank, bytes of a rank, messages of a rank."""
    def ranks(r):
        return r["ranks"]

    def depth(r):
        return log2_ceiling(r["ranks"])

    def depth_of_halves(r):  # of all groups that a rank is in while they are halved, up to a factor
        return depth(r) ** 2

    def moved(r):  # bytes of the points that are not at home already, each with its index
        return 24 * r["points"] / ranks(r) * (1 - 1 / ranks(r))

    def sort_seconds(r):
        return (rounds * network.all_reduce(ranks(r), 8 * ranks(r)) + 4 * network.all_to_all(ranks(r), 8)
                + moved(r) / network.bandwidth)

    def nothing(_):
        return 0.0

    def one(_):
        return 1.0

    def ghosts(r):
        return r["ghosts"] / ranks(r)

    def paths_sent(r):
        return r["longest_path"] * depth(r)

    def counted(r):  # of a count of 8 bytes from every rank to every other
        return 8 * ranks(r)

    return {
        "sort": (Growth(sort_seconds, one, depth),
                 # A border that is found drops out of the rounds, so their number is not all there is to know.
                 # And every rank sends, and gets, a sample of some size, from which the axis is chosen.
                 Growth(lambda r: moved(r) + 4 * counted(r), depth, lambda r: ranks(r) * depth(r),
                        lambda r: 1 - 1 / ranks(r)),
                 Growth(lambda r: 4 * (ranks(r) - 1), depth)),
        "split": (Growth(nothing, one, depth_of_halves, paths_sent),
                  Growth(lambda r: 2 * counted(r), depth_of_halves, paths_sent),
                  Growth(nothing, depth, depth_of_halves)),
        "stitch": (Growth(lambda r: 4 * counted(r) / network.bandwidth, one, depth, ghosts),
                   Growth(lambda r: 3 * counted(r), depth, ghosts), Growth(nothing, depth, ghosts)),
    }


def complete(record, exact):
    """Gives a sampled record the phases that it lacks, from at least two exact ones of the same distribution on several
    ranks."""
    exact = [run for run in exact if run["ranks"] > 1]
    ranks, network = record["ranks"], Network(record["network"])
    largest = max(exact, key=lambda run: run["ranks"])
    agreement = network.all_reduce(ranks, 4)
    phases = {"triangulate": {
        "wall_max_s": record["triangulate_max_s"] + agreement, "wall_mean_s": record["triangulate_max_s"] + agreement,
        "cpu_max_s": record["triangulate_max_s"], "cpu_sum_s": record["triangulate_mean_s"] * ranks,
        "bytes_sent": 4 * log2_ceiling(ranks) * ranks, "messages_sent": log2_ceiling(ranks) * ranks}}
    for name, (seconds, sent, messages) in growths(border_rounds(largest), network).items():
        def of_rank(key, n=name):
            return lambda run: phase(run, n)[key] / run["ranks"]
        wall = seconds.carry_on(exact, lambda run, n=name: phase(run, n)["wall_max_s"], record)
        work = Growth(lambda _: 0.0, lambda _: 1.0, lambda r: log2_ceiling(r["ranks"]), lambda r: r["longest_path"]) \
            .carry_on(exact, of_rank("cpu_sum_s"), record)
        phases[name] = {
            "wall_max_s": wall, "wall_mean_s": wall, "cpu_max_s": work, "cpu_sum_s": work * ranks,
            "bytes_sent": round(sent.carry_on(exact, of_rank("bytes_sent"), record) * ranks),
            "messages_sent": round(messages.carry_on(exact, of_rank("messages_sent"), record) * ranks)}
    record["phases"] = [{"name": name, **phases[name]} for name in PHASES]


def differences(sampled, exact):
    """How far a completed sampled record is from the exact one of the same set, as fractions, by what."""
    pairs = {"longest path": (sampled["longest_path"], exact["longest_path"])}
    for name in PHASES:
        pairs[name] = (phase(sampled, name)["wall_max_s"], phase(exact, name)["wall_max_s"])
    for key, words in (("bytes_sent", "bytes"), ("messages_sent", "messages")):
        pairs[words] = tuple(sum(p[key] for p in record["phases"]) for record in (sampled, exact))
    return {name: math.inf if there == 0 else here / there - 1 for name, (here, there) in pairs.items()}
