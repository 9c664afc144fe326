"""Heads: OBJ, PLY, STL and glTF as other programs write them."""
from gltf_file import Glb
from tool import farthest_mm, obj_lines, obj_points


def faces_of(path):
    faces = []
    for line in obj_lines(path):
        if line.startswith('f '):
            corners = [int(word.split('/')[0]) - 1 for word in line.split()[1:]]
            faces += [(corners[0], corners[i], corners[i + 1]) for i in range(1, len(corners) - 1)]
    return faces


def posed(bench, rig, name, extension='obj'):
    out = bench.out(f'{name}.{extension}')
    bench.well('pose', rig, '--set', 'jaw_open=0.6', '--level', 'low', '-o', out, '--quiet')
    return out


def ascii_stl(bench):
    source = bench.case('12-utm-coordinates/local.obj')
    points, facets = obj_points(source), []
    for face in faces_of(source):
        facets.append('facet normal 0 0 0\nouter loop\n' +
                      ''.join('vertex %.6f %.6f %.6f\n' % points[corner] for corner in face) + 'endloop\nendfacet\n')
    plain = 'solid head\n' + ''.join(facets) + 'endsolid head\n'
    rests = []
    for name, text in (('lower', plain), ('upper', plain.upper()), ('blank', '\n' + plain), ('bom', '\ufeff' + plain)):
        path = bench.out(name + '.stl')
        path.write_text(text, encoding='utf-8')
        rig = bench.rig(path)
        out = bench.out(name + '_skin.obj')
        bench.well('export', rig, '--part', 'skin', '-o', out, '--quiet')
        rests.append(obj_points(out))
    for other in rests[1:]:
        assert farthest_mm(rests[0], other)[1] == 0.0
    return f'four files, the same {len(rests[0])} vertices'


def wedge_texcoords(bench):
    shapes = []
    for name in ('uv_inside', 'uv_negative', 'uv_negative_ascii'):
        shapes.append(obj_points(posed(bench, bench.rig(bench.case(f'09-ply-wedge-texcoord/{name}.ply')), name)))
    # A coordinate that is another in its last digit may lay the lattice otherwise.
    means = [farthest_mm(shapes[0], shape)[0] for shape in shapes[1:]]
    assert max(means) < 0.2, f'poses differ by {max(means):.2f} mm in the mean'
    return f'all read; poses differ by {means[0]:.3f} and {means[1]:.3f} mm in the mean'


def folded_obj(bench):
    shapes = {}
    for name in ('crlf', 'folded_faces', 'folded_vertices', 'cr_only'):
        source = bench.case(f'11-obj-continuation/{name}.obj')
        shapes[name] = obj_points(posed(bench, bench.rig(source), name))
    rest = obj_points(bench.case('11-obj-continuation/crlf.obj'))
    moved = sum(a != b for a, b in zip(rest, shapes['crlf']))
    assert moved > 500, f'{moved} vertices moved'
    for name, points in shapes.items():
        assert farthest_mm(shapes['crlf'], points)[1] < 0.02, f'{name} poses otherwise'
    return f'all read, {moved} vertices moved, the same places'


def far_off(bench):
    """The offset is known: by it, poses are brought back to the one at the origin."""
    here = obj_points(posed(bench, bench.rig(bench.case('12-utm-coordinates/local.obj')), 'local'))
    rest = obj_points(bench.case('12-utm-coordinates/local.obj'))
    told = []
    for name in ('off_100', 'off_1000', 'off_5000', 'off_100000', 'utm'):
        source = bench.case(f'12-utm-coordinates/{name}.obj')
        away, there = obj_points(source), obj_points(posed(bench, bench.rig(source), name))
        # Z is up there: displacements are compared by their lengths.
        def lengths(before, after):
            return [1e3 * sum((p - q) ** 2 for p, q in zip(x, y)) ** 0.5 for x, y in zip(before, after)]
        gaps = [abs(a - b) for a, b in zip(lengths(rest, here), lengths(away, there))]
        mean = sum(gaps) / len(gaps)
        assert mean < 0.1, f'{name}: {mean:.2f} mm from the pose at the origin'
        told.append(f'{mean:.3f}')
    return f'mean {", ".join(told)} mm from the pose at the origin'


def missing_pictures(bench):
    for name in ('missing', 'backslash', 'percent', 'raw_utf8'):
        outcome = bench.well('build', bench.case(f'13-missing-texture/{name}.gltf'), '--detail', 'low', '-o', bench.out('t.glb'))
        if name in ('missing',):
            assert 'warning' in outcome.err and 'picture' in outcome.err.lower() or 'image' in outcome.err.lower(), outcome.err
    return 'built; a picture that is not there is a warning'


def picture_types(bench):
    rig = bench.rig(bench.case('14-webp-ktx2-mime/head.gltf'))
    types = sorted({image.get('mimeType', '?') for image in Glb(rig).json['images']})
    assert types == ['image/ktx2', 'image/webp'], types
    return ', '.join(types)


def shared_buffer(bench):
    sizes = {}
    for name in ('shared', 'own'):
        out = bench.out(name + '_arkit.glb')
        bench.well('bake', bench.rig(bench.case(f'16-shared-vertex-buffer/{name}.glb')), '--level', 'low', '-o', out, '--quiet')
        sizes[name] = out.stat().st_size / 1e6
    assert sizes['shared'] < 1.2 * sizes['own'], sizes
    return f"ARKit bake {sizes['shared']:.1f} MB, {sizes['own']:.1f} with buffers of their own"


def eye_instances(bench):
    for name in ('mirror_instance', 'translated_instance', 'flipped_root'):
        rig = bench.rig(bench.case(f'17-mirrored-eye-instance/{name}.glb'))
        document = Glb(rig).json
        meshes = [node['mesh'] for node in document['nodes'] if 'mesh' in node]
        assert len(meshes) == len(set(meshes)), f'{name}: a mesh on two nodes'
        # A blink of the left eye alone leaves the right half of the face alone, and a gaze turns one eye.
        places = {}
        for pose, values in (('rest', []), ('blink', ['arkit:eyeBlinkLeft=1']), ('look', ['eye_yaw_left=0.4'])):
            words = [word for value in values for word in ('--set', value)]
            bench.well('pose', rig, *words, '--level', 'low', '-o', bench.out('p.ply'), '--quiet')
            lines = bench.out('p.ply').read_text().split('end_header\n')[1].splitlines()
            count = int(bench.out('p.ply').read_text().split('element vertex ')[1].split()[0])
            places[pose] = [tuple(map(float, line.split()[:3])) for line in lines[:count]]
        for pose, most in (('blink', 20.0), ('look', 10.0)):
            gaps = [1e3 * sum((p - q) ** 2 for p, q in zip(x, y)) ** 0.5 for x, y in zip(places['rest'], places[pose])]
            assert 1.0 < max(gaps) < most, f'{name}: {pose} moves by up to {max(gaps):.1f} mm'
            sides = {side: max((g for g, p in zip(gaps, places['rest']) if side * p[0] > 0.012), default=0.0) for side in (1, -1)}
            assert min(sides.values()) < 0.6, f'{name}: {pose} of one side moves both: {sides}'
    return 'each node has a mesh of its own, and moves by its own channels'


def default_morphs(bench):
    for name in ('mesh_weights', 'node_weights'):
        rig = bench.rig(bench.case(f'18-default-morph-weights/{name}.glb'))
        _, out = bench.play(bench.case('18-default-morph-weights/take.csv'), rig=rig)
        glb = Glb(out)
        mesh = next(i for i, m in enumerate(glb.json['meshes']) if 'wide_jaw' in m.get('extras', {}).get('targetNames', []))
        at = glb.target_names(mesh).index('wide_jaw')
        targets = len(glb.json['meshes'][mesh]['primitives'][0]['targets'])
        assert not glb.broken_weight_clips()
        node = next(n for n in glb.json['nodes'] if n.get('mesh') == mesh)
        for weights in (glb.json['meshes'][mesh].get('weights'), node.get('weights')):
            assert weights is None or len(weights) == targets, f'{name}: {len(weights)} weights for {targets} targets'
        for animation in glb.json['animations']:
            for channel in animation['channels']:
                if channel['target'].get('path') == 'weights' and glb.json['nodes'][channel['target']['node']].get('mesh') == mesh:
                    values = glb.numbers(animation['samplers'][channel['sampler']]['output'])
                    assert all(abs(v - 0.8) < 1e-6 for v in values[at::targets]), f'{name}: the clip moves wide_jaw'
    return 'wide_jaw stays at 0.8 through the clip; weights have the length of the targets'


def weight_clips(bench):
    rig = bench.rig(bench.case('19-weights-animation/animated.glb'))
    out = bench.out('animated_arkit.glb')
    bench.well('bake', rig, '--level', 'low', '-o', out, '--quiet')
    glb = Glb(out)
    assert not glb.broken_weight_clips(), glb.broken_weight_clips()
    for mesh in range(len(glb.json['meshes'])):
        names = glb.target_names(mesh)
        assert len(names) == len(set(names)), 'a name is doubled'
    return 'the clip is lengthened, no name is doubled'


def baked_normals(bench):
    out = bench.out('plain_arkit.glb')
    bench.well('bake', bench.rig(), '--level', 'low', '-o', out, '--quiet')
    glb = Glb(out)
    targets = [target for p in glb.primitives() for target in p.get('targets', [])]
    empty = [a for a in glb.json['accessors'] if 'bufferView' not in a and 'sparse' not in a]
    assert targets and all('NORMAL' in target for target in targets), 'targets without NORMAL'
    assert not empty, f'{len(empty)} accessors without data'
    still = [m['name'] for m in glb.json['meshes'] for p in m['primitives'] if p.get('targets') and
             not any(any(glb.numbers(t['POSITION'])) for t in p['targets'])]
    assert not still, f'targets that move nothing: {still}'
    return f'{len(targets)} targets with NORMAL, no empty accessor; {out.stat().st_size / 1e6:.1f} MB'


CASES = [
    ('07 ASCII STL in capitals, blank line, BOM', 'read as the plain one', ascii_stl),
    ('09 PLY with texture coordinates by corner', 'all read, coordinates are no vertices', wedge_texcoords),
    ('11 OBJ folded lines, CR only, CR LF', 'all read, a posed OBJ has moved', folded_obj),
    ('12 map coordinates', 'the pose it has at the origin', far_off),
    ('13 missing picture', 'built, with a warning', missing_pictures),
    ('14 WebP and KTX2', 'media types of their own', picture_types),
    ('16 shared vertex buffer', 'about the size of separate buffers', shared_buffer),
    ('17 one eye mesh on two nodes', 'each eye by its own channels', eye_instances),
    ('18 morph targets on by default', 'looks kept, weights as long as targets', default_morphs),
    ('19 a clip over morph weights', 'lengthened, no double names', weight_clips),
    ('20 normals of baked shapes', 'NORMAL in all targets, no empty accessor', baked_normals),
]
