"""Takes: rates, separators, times, names, lengths."""
from gltf_file import Glb


def frame_rates(bench):
    """One ramp of two seconds, counted at 24, 30 and 60 frames a second."""
    found = []
    for rate in (24, 30, 60):
        outcome, out = bench.play(bench.case(f'01-live-link-30fps/take_{rate}.csv'))
        assert f'{rate} frames a second' in outcome.err, 'the rate is not said'
        assert abs(outcome.report['seconds'] - 2.0) < 0.05, f"{outcome.report['seconds']} s at {rate} a second"
        found.append([Glb(out).channel_at('jaw_open', t) for t in (0.5, 1.0, 1.5)])
    for values in found[1:]:
        assert max(abs(a - b) for a, b in zip(values, found[0])) < 0.02, f'jaws differ: {found}'
    assert found[0][0] > 0.05 and found[0][2] > found[0][1] > found[0][0], f'no ramp: {found[0]}'
    return f'jaw at 0.5 s {", ".join(f"{v[0]:.3f}" for v in found)}'


def audio2face(bench):
    jaws = []
    for name in ('with', 'no'):
        outcome, out = bench.play(bench.case(f'02-audio2face3d-csv/animation_frames_{name}_index.csv'))
        assert len(outcome.report['matched']) == 4 and not outcome.report['unmatched'], outcome.report['unmatched']
        jaws.append(Glb(out).channel_at('jaw_open', 0.5))
    assert jaws[0] == jaws[1] and jaws[0] > 0.01, f'jaws at 0.5 s: {jaws}'
    return f'both play, jaw at 0.5 s {jaws[0]:.3f}'


def separators(bench):
    jaws = []
    for name in ('excel_de', 'semicolon_point', 'utf16'):
        outcome, out = bench.play(bench.case(f'04-semicolon-decimal-comma/{name}.csv'))
        assert abs(outcome.report['seconds'] - 1.0) < 0.02
        jaws.append(Glb(out).channel_at('jaw_open', 0.5))
    assert abs(jaws[0] - jaws[1]) < 1e-3, f'jaws at 0.5 s: {jaws}'
    assert min(jaws) > 0.01
    return f'all read, jaw at 0.5 s {", ".join(f"{jaw:.3f}" for jaw in jaws)}'


def epoch_times(bench):
    starts = []
    for name, seconds in (('two_rows', 0.5), ('epoch', 1.0), ('day', 1.0), ('preroll', 1.0)):
        outcome, out = bench.play(bench.case(f'05-epoch-time/{name}.csv'))
        assert abs(outcome.report['seconds'] - seconds) < 0.02, f"{name}: {outcome.report['seconds']} s"
        times, _ = Glb(out).channel('jaw_open')
        assert times and times[0] == 0.0 and abs(times[-1] - seconds) < 0.02, f'{name}: keys from {times[:1]}'
        starts.append(f"{outcome.report['start_seconds']:g}")
    return f'clips from 0; takes began at {", ".join(starts)} s'



def spellings(bench):
    known = 0
    for file in sorted(bench.case('06-shape-name-variants').glob('n*.csv')):
        outcome, _ = bench.play(file)
        name = file.read_text().splitlines()[0].split(',')[2]
        if outcome.report['unmatched'] and name == 'HeadYaw':  # node animation, when asked
            assert '--head' in outcome.err, 'HeadYaw: nothing said of --head'
        else:
            assert not outcome.report['unmatched'], f"{name} is not known"
        known += 1
    assert known > 40
    return f'{known} of {known} spellings known'


def long_takes(bench):
    seconds, megabytes = [], []
    for length in (10, 20, 40, 60):
        outcome, _ = bench.play(bench.case(f'23-long-take/take_{length}s.csv'), '--threads', '1')
        seconds.append(outcome.seconds)
        megabytes.append(outcome.megabytes)
        assert outcome.report['largest_error_mm'] <= 0.1, f"{outcome.report['largest_error_mm']} mm"
    assert seconds[3] < 60, f'slower than real time: {seconds}'
    assert (seconds[3] - seconds[1]) / (seconds[1] - seconds[0]) < 8, f'not linear: {seconds}'
    return f'{", ".join(f"{s:.1f}" for s in seconds)} s of processor for 10, 20, 40, 60 s; {max(megabytes):.0f} MB at most'


CASES = [
    ('01 Live Link at 24, 30, 60 fps', 'the same ramp from all three', frame_rates),
    ('02 Audio2Face-3D CSV', 'timeCode in seconds, prefix passed over, index or none', audio2face),
    ('04 semicolons, decimal commas, UTF-16', 'all read, with the same values', separators),
    ('05 time since 1970, of the day, before 0', 'the clip begins at the first key', epoch_times),
    ('06 spellings of names', 'every one known', spellings),
    ('23 long takes', 'linear, faster than real time, error at most 0.1 mm', long_takes),
]
