"""What the checks read of a GLB file, without other libraries."""
import array
import json
import struct

SIZES = {'SCALAR': 1, 'VEC2': 2, 'VEC3': 3, 'VEC4': 4}
KINDS = {5121: 'B', 5123: 'H', 5125: 'I', 5126: 'f'}


class Glb:
    def __init__(self, path):
        with open(path, 'rb') as file:
            data = file.read()
        length = struct.unpack_from('<I', data, 12)[0]
        self.json = json.loads(data[20:20 + length])
        self.bin = data[28 + length:]

    def _raw(self, view, offset, kind, count):
        values = array.array(KINDS[kind])
        start = self.json['bufferViews'][view].get('byteOffset', 0) + offset
        values.frombytes(self.bin[start:start + count * values.itemsize])
        return values

    def numbers(self, index):
        """The numbers of an accessor, one after the other; sparse ones filled in. Tightly packed data only."""
        accessor = self.json['accessors'][index]
        width = SIZES[accessor['type']]
        count = width * accessor['count']
        if 'bufferView' in accessor:
            values = self._raw(accessor['bufferView'], accessor.get('byteOffset', 0), accessor['componentType'], count)
        else:
            values = array.array(KINDS[accessor['componentType']], [0] * count)
        if 'sparse' in accessor:
            sparse = accessor['sparse']
            at = self._raw(sparse['indices']['bufferView'], sparse['indices'].get('byteOffset', 0),
                           sparse['indices']['componentType'], sparse['count'])
            new = self._raw(sparse['values']['bufferView'], sparse['values'].get('byteOffset', 0),
                            accessor['componentType'], width * sparse['count'])
            for i, place in enumerate(at):
                values[width * place:width * (place + 1)] = new[width * i:width * (i + 1)]
        return values

    def channel(self, name):
        """Times and values of a rig's channel, from pointer animation; two empty lists where there is none."""
        number = next(i for i, c in enumerate(self.json['extensions']['FASCIA_actuation']['channels']) if c['name'] == name)
        pointer = f'/extensions/FASCIA_actuation/channels/{number}/value'
        for animation in self.json.get('animations', []):
            for channel in animation['channels']:
                target = channel['target'].get('extensions', {}).get('KHR_animation_pointer', {})
                if target.get('pointer') == pointer:
                    sampler = animation['samplers'][channel['sampler']]
                    return list(self.numbers(sampler['input'])), list(self.numbers(sampler['output']))
        return [], []

    def channel_at(self, name, time):
        """A channel's value at `time`, linear between keys; None where it has no curve."""
        times, values = self.channel(name)
        if not times:
            return None
        if time <= times[0]:
            return values[0]
        for i in range(1, len(times)):
            if time <= times[i]:
                share = (time - times[i - 1]) / (times[i] - times[i - 1])
                return (1 - share) * values[i - 1] + share * values[i]
        return values[-1]

    def primitives(self):
        return [p for mesh in self.json['meshes'] for p in mesh['primitives']]

    def target_names(self, mesh):
        return self.json['meshes'][mesh].get('extras', {}).get('targetNames', [])

    def broken_weight_clips(self):
        """Samplers of morph weights whose values do not fit the number of targets."""
        broken = []
        for animation in self.json.get('animations', []):
            for channel in animation['channels']:
                if channel['target'].get('path') != 'weights':
                    continue
                mesh = self.json['meshes'][self.json['nodes'][channel['target']['node']]['mesh']]
                sampler = animation['samplers'][channel['sampler']]
                keys = self.json['accessors'][sampler['input']]['count']
                keys *= 3 if sampler.get('interpolation') == 'CUBICSPLINE' else 1
                if self.json['accessors'][sampler['output']]['count'] != keys * len(mesh['primitives'][0]['targets']):
                    broken.append(animation.get('name', '?'))
        return broken
