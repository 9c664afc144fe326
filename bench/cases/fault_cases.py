"""Inputs that broke the tool: refused in a sentence, or right."""


def refused(name, says=()):
    def check(bench):
        path = bench.case('faults/' + name)
        if path.suffix in ('.csv', '.json') or 'anim_' in name:
            return bench.refused('play', bench.rig(), '--curves', path, '-o', bench.out('x.glb'), says=says, memory_kb=4000000,
                                 timeout=120)
        return bench.refused('build', path, '-o', bench.out('x.glb'), '--detail', 'low', says=says, memory_kb=4000000, timeout=120)
    return check


def plays(name, seconds):
    def check(bench):
        outcome, _ = bench.play(bench.case('faults/' + name))
        assert abs(outcome.report['seconds'] - seconds) < 0.1, f"{outcome.report['seconds']} s"
        return f"{outcome.report['seconds']:.2f} s from {outcome.report['start_seconds']:g} s"
    return check


def builds(name):
    """Built and posed, or refused in a sentence; never a crash, never numbers that are not finite."""
    def check(bench):
        rig = bench.out('fault.glb')
        outcome = bench.run('build', bench.case('faults/' + name), '-o', rig, '--detail', 'low', '--json')
        if outcome.code == 1:
            return 'refused: ' + outcome.err.strip().splitlines()[-1][-90:]
        assert outcome.code == 0, outcome.err[:200]
        outcome.report  # JSON whatever the names in the file
        bench.well('info', rig, '--validate', '--json')
        out = bench.out('fault.ply')
        bench.well('pose', rig, '--set', 'jaw_open=0.3', '-o', out, '--quiet')
        text = out.read_text()
        assert 'nan' not in text and 'inf' not in text, 'a pose that is not finite'
        return 'built and posed'
    return check


def contained(bench):
    rig = bench.out('outside.glb')
    outcome = bench.run('build', bench.case('faults/img_outside.gltf'), '-o', rig, '--detail', 'low')
    if outcome.code == 0:
        assert 'outside' in outcome.err, f'nothing is said of the file outside: {outcome.err[:200]}'
        assert b'root:x:0' not in rig.read_bytes(), 'a file of the machine is in the rig'
        return 'left out, with a warning'
    return 'refused: ' + outcome.err.strip()[-90:]


CASES = [
    ('fault: times up to 1e300', 'refused', refused('time_1e300.csv', says=('hours',))),
    ('fault: times up to 1e9', 'refused', refused('time_1e9.csv', says=('hours',))),
    ('fault: times up to 1e12 in JSON', 'refused', refused('t1e12.json', says=('hours',))),
    ('fault: a value of 1e39', 'refused', refused('val_1e39.csv', says=('jaw_open',))),
    ('fault: times since 1970', 'from the first key', plays('time_unix.csv', 0.28)),
    ('fault: times from 1e5 s', 'from the first key', plays('time_start_1e5.csv', 0.2)),
    ('fault: negative times', 'all keys', plays('time_neg.csv', 4.0)),
    ('fault: decimal commas', 'read', plays('semi_comma.csv', 0.32)),
    ('fault: JSON nested too deep', 'refused', refused('json_deep_extras.glb', says=('deep',))),
    ('fault: curves nested too deep', 'refused', refused('anim_deep.glb', says=('deep',))),
    ('fault: an offset that wraps', 'refused', refused('acc_wrap_4096.glb')),
    ('fault: a sparse count of 1e9', 'refused without taking memory', refused('sparse_count_1e9.glb')),
    ('fault: NaN in an OBJ', 'refused by line', refused('obj_nan.obj', says=('line',))),
    ('fault: names that are no UTF-8', 'built, JSON stays JSON', builds('json_rawbad.glb')),
    ('fault: an OBJ that is no UTF-8', 'built', builds('badutf8.obj')),
    ('fault: a byte order mark', 'built', builds('bom.obj')),
    ('fault: far off', 'built or refused', builds('offset_2e4.obj')),
    ('fault: rounded to 1 mm', 'built or refused', builds('rounded_1mm.obj')),
    ('fault: rounded to 0.5 mm', 'built or refused', builds('round_0.5mm.obj')),
    ('fault: quantised to 8 bits', 'built or refused', builds('quantised_8bit.glb')),
    ('fault: a head of 1e-30', 'built or refused', builds('scale_1e-30.obj')),
    ('fault: a node that scales to nothing', 'built or refused', builds('tiny_scale_node.glb')),
    ('fault: a picture outside the folder', 'its file stays out of the rig', contained),
]
