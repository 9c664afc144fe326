"""Runs the tool on the cases."""
import json
import resource
import subprocess


class Skipped(Exception):
    pass


class Outcome:
    def __init__(self, code, out, err, seconds, megabytes):
        self.code, self.out, self.err, self.seconds, self.megabytes = code, out, err, seconds, megabytes

    @property
    def report(self):
        return json.loads(self.out)


class Bench:
    """Where the tool, the cases and the results are."""

    _before = 0.0  # processor seconds of what has run

    def __init__(self, fascia, cases, folder, root):
        self.fascia, self.cases, self.folder, self.root = fascia, cases, folder, root
        self._rigs = {}

    def case(self, name):
        path = self.cases / name
        if not path.exists():
            raise Skipped(f'{name} is not there')
        return path

    def out(self, name):
        return self.folder / name

    def run(self, *words, memory_kb=None, timeout=1200):
        """Ends well or badly, but never by a signal."""
        command = [str(self.fascia), *map(str, words)]
        if memory_kb:
            command = ['sh', '-c', f'ulimit -v {memory_kb}; exec "$@"', 'sh', *command]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=self.folder)
        try:
            out, err = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            process.kill()
            raise AssertionError(f'{words[0]} had not ended after {timeout} s')
        after = self._usage()
        assert process.returncode >= 0, f'{words[0]} ended by signal {-process.returncode}'
        return Outcome(process.returncode, out.decode(errors='replace'), err.decode(errors='replace'), after[0], after[1])

    def _usage(self):
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = usage.ru_utime - self._before
        self._before = usage.ru_utime
        return seconds, usage.ru_maxrss / 1024

    def well(self, *words, **options):
        outcome = self.run(*words, **options)
        assert outcome.code == 0, f'{words[0]} ended with {outcome.code}: {outcome.err[:200]}'
        return outcome

    def refused(self, *words, says=(), **options):
        """Refused with 1 and a message that holds every one of `says`."""
        outcome = self.run(*words, **options)
        assert outcome.code == 1, f'{words[0]} ended with {outcome.code}, not 1: {outcome.err[:200]}'
        for part in says:
            assert part in outcome.err, f'the message lacks "{part}": {outcome.err[:200]}'
        return 'refused: ' + outcome.err.strip().splitlines()[-1].split(': ', 1)[-1][:90]

    def rig(self, head=None):
        """A rig of `head` at low detail; the embedded head's without. Built once."""
        key = str(head)
        if key not in self._rigs:
            path = self.out(f'rig_{len(self._rigs)}.glb')
            self._rigs[key] = path
            if head is None:
                head = self.cases / '12-utm-coordinates/local.obj'
            self.well('build', head, '--detail', 'low', '-o', path, '--quiet')
        return self._rigs[key]

    def play(self, curves, *words, rig=None):
        """Plays curves on a rig at low detail: the report, and the file that came out."""
        out = self.out('play.glb')
        outcome = self.well('play', rig or self.rig(), '--curves', curves, '--level', 'low', '-o', out, '--json', *words)
        return outcome, out


def obj_lines(path):
    """Lines of an OBJ, folded ones in one."""
    with open(path, errors='replace', newline=None) as file:
        return file.read().replace('\\\n', ' ').splitlines()


def obj_points(path):
    return [tuple(map(float, line.split()[1:4])) for line in obj_lines(path) if line.startswith('v ')]


def farthest_mm(a, b, metres=1.0):
    """Mean and largest distance between points in order, in millimetres."""
    assert len(a) == len(b), f'{len(a)} and {len(b)} points'
    gaps = [1e3 * metres * sum((p - q) ** 2 for p, q in zip(x, y)) ** 0.5 for x, y in zip(a, b)]
    return sum(gaps) / len(gaps), max(gaps)
