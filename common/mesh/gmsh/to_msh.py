# SPDX-License-Identifier: Apache-2.0
"""MESH MSH NAME writes an input deck (.inp), universal file (.unv), MED, Exodus, SU2 or Nastran file as a .msh. Part of the programs (gmsh.cpp), which run
deck.py, deck_mesh.py and this text as one script in their sandbox and call the file NAME in messages; prints what it leaves out. Needs h5py for MED and
for Exodus in HDF5 (netCDF-4), nothing otherwise."""
import array, re, struct
# Cells: dimension and numbers of nodes by family, the first of which are the corners. Faces of Exodus, by corners from 0.
SHAPES = {'C3D4': (3, 4, (4, 8, 10, 11, 14, 15), ((0, 1, 3), (1, 2, 3), (0, 3, 2), (0, 2, 1))),
          'C3D8': (3, 8, (8, 9, 20, 26, 27), ((0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (0, 4, 7, 3), (0, 3, 2, 1), (4, 5, 6, 7))),
          'C3D6': (3, 6, (6, 12, 15, 16, 18, 20, 21), ((0, 1, 4, 3), (1, 2, 5, 4), (0, 3, 5, 2), (0, 2, 1), (3, 4, 5))),
          'C3D5': (3, 5, (5, 13, 14, 18, 19), ((0, 1, 4), (1, 2, 4), (2, 3, 4), (0, 4, 3), (0, 3, 2, 1))),
          'CPS3': (2, 3, (3, 4, 6, 7), ((0, 1), (1, 2), (2, 0))), 'CPS4': (2, 4, (4, 5, 8, 9), ((0, 1), (1, 2), (2, 3), (3, 0))),
          'T2D2': (1, 2, (2, 3), ())}
NODES, CELLS, SETS, LEFT, second = {}, [], {}, {}, 0  # CELLS: family, corners, groups; LEFT: what is not read and how often
BLOCKS = set()  # groups that name only faces that no set has: blocks of Exodus, properties of Nastran
def leave(what, n=1):
    LEFT[what] = LEFT.get(what, 0) + n
def cell(family, nodes, groups):
    global second
    second += len(nodes) > SHAPES[family][1]
    CELLS.append((family, tuple(nodes[:SHAPES[family][1]]), groups))
    return len(CELLS) - 1

def read_unv(name):
    with open(name, encoding='latin-1') as file:
        lines = iter(file.read().splitlines())
    place, unit, groups, unread = {}, 1.0, {}, set()
    VOLUMES = {4: 'C3D4', 10: 'C3D4', 6: 'C3D6', 15: 'C3D6', 8: 'C3D8', 20: 'C3D8', 5: 'C3D5', 13: 'C3D5'}
    RING = {('C3D4', 10): (0, 2, 4, 9), ('C3D6', 15): (0, 2, 4, 9, 11, 13), ('C3D8', 20): (0, 2, 4, 6, 12, 14, 16, 18), ('C3D5', 13): (0, 2, 4, 6, 12),
            ('CPS3', 6): (0, 2, 4), ('CPS4', 8): (0, 2, 4, 6), ('T2D2', 3): (0, 2)}
    whole = lambda line: [int(word) for word in line.split()]
    real = lambda line: [float(word) for word in line.replace('D', 'e').replace('d', 'e').split()]
    found = False
    for line in lines:
        if line.strip() != '-1':
            continue
        kind = next(lines, '').strip()
        body = iter(list(itertools.takewhile(lambda text: text.strip() != '-1', lines)))
        found = found or kind.isdigit()
        if kind == '164':
            next(body)
            unit = real(next(body))[0]
        elif kind in ('15', '781', '2411'):
            for line in body:
                words = line.split()
                NODES[int(words[0])] = real(next(body))[:3] if kind != '15' else real(' '.join(words[4:7]))
        elif kind in ('71', '780', '2412'):
            for line in body:
                words = whole(line)
                descriptor, n = words[1], words[-1]
                if kind != '71' and descriptor in (11, 21, 22, 23, 24, 31, 32):
                    next(body)  # orientation and sections of a beam
                nodes = []
                while len(nodes) < n:
                    nodes += whole(next(body))
                family = (VOLUMES.get(n) if 111 <= descriptor <= 118 or descriptor in (101, 104) else {3: 'CPS3', 6: 'CPS3', 4: 'CPS4', 8: 'CPS4'}.get(n)
                          if 41 <= descriptor <= 95 else {2: 'T2D2', 3: 'T2D2'}.get(n) if 11 <= descriptor <= 32 else None)
                if family is None:
                    leave('elements of the type %d are not read' % descriptor)
                    continue
                place[words[0]] = cell(family, [nodes[k] for k in RING.get((family, n), range(n))] + [0] * (n - SHAPES[family][1]), [])
        elif kind in ('2417', '2429', '2430', '2432', '2435', '2452', '2467', '2477'):
            step = 2 if kind in ('2417', '2429', '2430', '2432') else 4
            for line in body:
                n, title, words = whole(line)[-1], next(body).strip(), []
                while len(words) < step * n:
                    words += whole(next(body))
                groups.setdefault(title or 'group_%d' % whole(line)[0], []).extend(zip(words[0::step], words[1::step]))
        elif kind == '2420':
            rows = [real(line) for i, line in enumerate(list(body)[2:]) if i % 6 > 1]
            if any(row != [float(i % 4 == k) for k in range(3)] for i, row in enumerate(rows)):
                unread.add('2420 (coordinate systems)')
        elif kind not in ('151', '2400'):
            unread.add(kind)
    if not found or not NODES:
        raise Problem('it has no nodes (dataset 2411), so it is no universal file or not of a mesh')
    for title, members in groups.items():
        for kind, label in members:
            if kind == 8 and label in place:
                CELLS[place[label]][2].append(title)
            elif kind == 7 and label in NODES:
                SETS.setdefault(title, []).append(label)
            else:
                leave("members of the group '%s' are not read: they are neither nodes nor elements that were read" % title)
    if unread:
        say('these datasets are not read: ' + ', '.join(sorted(unread)), 'warning')
    rescale(1 / unit, 'its dataset 164')

def rescale(unit, where):
    if unit != 1:
        say('lengths are in units of %.6g m (%s) and are converted; a mesh-scale would multiply them again' % (unit, where))
        for label in NODES:
            NODES[label] = [unit * x for x in NODES[label]]

def h5py_file(name):
    try:
        import h5py
    except ImportError:
        print('python3-h5py')
        sys.exit(3)
    return h5py.File(name, 'r')

def text(value):
    value = value.tobytes() if hasattr(value, 'tobytes') and not isinstance(value, bytes) else value
    return (value if isinstance(value, str) else bytes(value).decode('utf-8', 'replace')).split('\0')[0].strip()

def read_med(name):
    TYPES = {'SE': 'T2D2', 'TR': 'CPS3', 'QU': 'CPS4', 'TE': 'C3D4', 'T1': 'C3D4', 'PY': 'C3D5', 'P13': 'C3D5', 'PE': 'C3D6', 'P15': 'C3D6', 'P18': 'C3D6',
             'HE': 'C3D8', 'H2': 'C3D8'}
    file = h5py_file(name)
    if 'ENS_MAA' not in file or not len(file['ENS_MAA']):
        raise Problem('it has no mesh (ENS_MAA), so it is no MED file of a mesh')
    if len(file['ENS_MAA']) > 1:
        raise Problem('it has several meshes (%s); export one' % ', '.join(file['ENS_MAA']))
    title = list(file['ENS_MAA'])[0]
    mesh = file['ENS_MAA'][title]
    steps = [key for key in mesh if key not in ('NOE', 'MAI')] if 'NOE' not in mesh else []
    units = text(mesh.attrs.get('UNI', b'')).split()
    if len(steps) > 1:
        leave('further steps of the mesh are not read', len(steps) - 1)
    mesh = mesh[steps[0]] if steps else mesh
    if 'NOE' not in mesh or 'MAI' not in mesh:
        raise Problem('its mesh is structured or empty; export it with nodes and cells written out')
    names = {}
    for kind in ('NOEUD', 'ELEME'):
        for family in (file['FAS/%s/%s' % (title, kind)].values() if 'FAS/%s/%s' % (title, kind) in file else []):
            if 'GRO' in family:
                names[kind, int(family.attrs['NUM'])] = [text(bytes(b & 255 for b in row)) for row in family['GRO/NOM'][()].tolist()]
    n = int(mesh['NOE/COO'].attrs['NBR'])
    flat = mesh['NOE/COO'][()].tolist()
    for i in range(n):
        NODES[i + 1] = flat[i::n]
    for i, family in enumerate(mesh['NOE/FAM'][()].tolist() if 'NOE/FAM' in mesh else []):
        for group in names.get(('NOEUD', family), []):
            SETS.setdefault(group, []).append(i + 1)
    for kind, block in mesh['MAI'].items():
        family = TYPES.get(kind) or TYPES.get(kind[:2])
        if kind == 'PO1':
            continue
        if family is None or 'NOD' not in block:
            leave("elements of the type '%s' are not read" % kind)
            continue
        n = int(block['NOD'].attrs['NBR'])
        flat = block['NOD'][()].tolist()
        families = block['FAM'][()].tolist() if 'FAM' in block else [0] * n
        for i in range(n):
            cell(family, flat[i::n], list(names.get(('ELEME', families[i]), [])))
    known = {'m': 1, 'dm': 0.1, 'cm': 0.01, 'mm': 0.001, 'in': 0.0254, 'inch': 0.0254, 'ft': 0.3048}
    if units and units[0].lower() in known:
        rescale(known[units[0].lower()], "its unit '%s'" % units[0])
    elif units:
        say("its unit of length '%s' is not known; the numbers are taken as m" % units[0])

class Classic:
    """netCDF of the formats classic, 64-bit offset and 64-bit data."""
    def __init__(self, name):
        with open(name, 'rb') as file:
            self.data = file.read()
        self.at, version = 4, self.data[3]
        self.offset, self.number = ('>q' if version > 1 else '>i'), ('>q' if version == 5 else '>i')
        self.take(self.number)  # records
        self.dims = self.list(lambda: (self.name(), self.take(self.number)))
        self.list(self.attribute)
        self.variables = dict(self.list(self.variable))
    def take(self, kind):
        value, = struct.unpack_from(kind, self.data, self.at)
        self.at += struct.calcsize(kind)
        return value
    def name(self):
        n = self.take(self.number)
        word = self.data[self.at:self.at + n].decode('utf-8', 'replace')
        self.at += (n + 3) // 4 * 4
        return word
    def list(self, item):
        self.take('>i')
        n = self.take(self.number)
        if n > len(self.data):
            raise Problem('it is damaged: a list in its head is too long')
        return [item() for _ in range(n)]
    KINDS = {1: 'b', 2: 'c', 3: 'h', 4: 'i', 5: 'f', 6: 'd', 7: 'B', 8: 'H', 9: 'I', 10: 'q', 11: 'Q'}
    def values(self, kind, n, at):
        code = self.KINDS[kind]
        size = struct.calcsize('>' + code)
        part = self.data[at:at + n * size]
        if len(part) < n * size:
            raise Problem('it is cut off')
        if code in 'bc':
            return part
        result = array.array(code, part)
        if sys.byteorder == 'little':
            result.byteswap()
        return result.tolist()
    def attribute(self):
        name, kind, n = self.name(), self.take('>i'), self.take(self.number)
        value = self.values(kind, n, self.at)
        self.at += (n * struct.calcsize('>' + self.KINDS[kind]) + 3) // 4 * 4
        return name, value
    def variable(self):
        name = self.name()
        n = self.take(self.number)
        dims = [self.dims[self.take(self.number)] for _ in range(n)]
        attributes = dict(self.list(self.attribute))
        kind = self.take('>i')
        self.take(self.number)
        return name, ([size for _, size in dims], attributes, kind, self.take(self.offset))
    def __contains__(self, name):
        return name in self.variables
    def read(self, name):
        shape, _, kind, at = self.variables[name]
        n = 1
        for size in shape:
            n *= size
        return self.values(kind, n, at), shape
    def kind(self, name):
        return self.variables[name][1].get('elem_type', b'')

class Hdf5:
    def __init__(self, name):
        self.file = h5py_file(name)
    def __contains__(self, name):
        return name in self.file
    def read(self, name):
        data = self.file[name][()]
        return (data.tobytes() if data.dtype.kind == 'S' else data.ravel().tolist()), data.shape
    def kind(self, name):
        return self.file[name].attrs.get('elem_type', b'')

def read_exodus(name):
    with open(name, 'rb') as file:
        head = file.read(4)
    if head[:3] != b'CDF' and head != b'\x89HDF':
        raise Problem('it is no Exodus file, which is netCDF')
    file = Classic(name) if head[:3] == b'CDF' else Hdf5(name)
    if 'coordx' not in file and 'coord' not in file:
        raise Problem('it has no coordinates, so it is no Exodus file of a mesh')
    if 'coord' in file:
        flat, (dim, n) = file.read('coord')
        axes = [flat[a * n:(a + 1) * n] for a in range(dim)]
    else:
        axes = [file.read('coord' + a)[0] for a in 'xyz' if 'coord' + a in file]
    for i, x in enumerate(zip(*axes)):
        NODES[i + 1] = list(x)
    def names(prefix, word):
        ids = file.read(prefix + '_prop1')[0] if prefix + '_prop1' in file else []
        given = []
        if prefix + '_names' in file:
            raw, (n, width) = file.read(prefix + '_names')
            given = [text(raw[i * width:(i + 1) * width]) for i in range(n)]
        n = max(len(ids), len(given), file.read(prefix + '_status')[1][0] if prefix + '_status' in file else 0)
        return [(given[i] if i < len(given) and given[i] else '%s_%d' % (word, ids[i] if i < len(ids) else i + 1)) for i in range(n)]
    FAMILIES = (('TET', 'C3D4'), ('HEX', 'C3D8'), ('WED', 'C3D6'), ('PRI', 'C3D6'), ('PEN', 'C3D6'), ('PYR', 'C3D5'), ('TRI', 'CPS3'), ('QUA', 'CPS4'),
                ('SHE', 'SHELL'), ('BAR', 'T2D2'), ('BEA', 'T2D2'), ('TRU', 'T2D2'), ('ROD', 'T2D2'), ('EDG', 'T2D2'), ('LIN', 'T2D2'))
    where = []
    BLOCKS.update(names('eb', 'block'))
    for b, title in enumerate(names('eb', 'block'), 1):
        if 'connect%d' % b not in file:
            continue
        kind = text(file.kind('connect%d' % b)).upper()
        nodes, (n, width) = file.read('connect%d' % b)
        family = dict(FAMILIES).get(kind[:3])
        is_shell = family == 'SHELL' or kind.startswith('TRI') and len(axes) == 3
        if family == 'SHELL':
            family = 'CPS3' if width in (3, 6) else 'CPS4'
        if kind.startswith('HEXSHELL') or family is None or width not in SHAPES[family][2]:
            if n:
                leave("elements of the type '%s' with %d nodes (block '%s') are not read" % (kind, width, title), n)
            where += [None] * n
            continue
        for e in range(n):
            where.append((cell(family, nodes[e * width:(e + 1) * width], [title]), is_shell))
    for s, title in enumerate(names('ns', 'nodes'), 1):
        if 'node_ns%d' % s in file:
            SETS[title] = list(file.read('node_ns%d' % s)[0])
    is_solid = any(SHAPES[family][0] == 3 for family, _, _ in CELLS)
    for s, title in enumerate(names('ss', 'sides'), 1):
        if 'elem_ss%d' % s not in file:
            continue
        for e, side in zip(file.read('elem_ss%d' % s)[0], file.read('side_ss%d' % s)[0]):
            at = where[e - 1] if 1 <= e <= len(where) else None
            family, corners, groups = CELLS[at[0]] if at else (None, (), ())
            if at and at[1] and side <= 2 and is_solid:
                groups.append(title)  # the face itself; edges follow
                continue
            side -= 2 if at and at[1] else 0
            faces = SHAPES[family][3] if at else ()
            if not 1 <= side <= len(faces):
                leave("sides of the set '%s' are not read: the element has no such face, or is not read" % title)
                continue
            face = [corners[k] for k in faces[side - 1]]
            cell({2: 'T2D2', 3: 'CPS3', 4: 'CPS4'}[len(face)], face, [title])
    if any(key in file for key in ('vals_nod_var1', 'vals_nod_var', 'vals_elem_var1eb1')):
        say('results in the file are not read, only its mesh')

def read_su2(name):
    with open(name, encoding='latin-1') as file:
        rows = iter([line for line in (line.split('%')[0].strip() for line in file) if line])
    FAMILIES = {3: 'T2D2', 5: 'CPS3', 9: 'CPS4', 10: 'C3D4', 12: 'C3D8', 13: 'C3D6', 14: 'C3D5'}
    def elements(n, groups):
        for line in itertools.islice(rows, n):
            words = [int(word) for word in line.split()]
            family = FAMILIES.get(words[0])
            if family is None:
                leave('elements of the type %d are not read' % words[0])
                continue
            cell(family, [word + 1 for word in words[1:SHAPES[family][1] + 1]], list(groups))
    dim, tag = 3, ''
    for line in rows:
        key, _, value = (part.strip() for part in line.partition('='))
        if key == 'NDIME':
            dim = int(value)
        elif key == 'NZONE' and int(value) > 1:
            raise Problem('it has several zones; write each to a file of its own')
        elif key == 'NELEM':
            elements(int(value), [])
        elif key == 'NPOIN':
            for i, line in enumerate(itertools.islice(rows, int(value.split()[0])), 1):
                NODES[i] = [float(word) for word in line.split()[:dim]]
        elif key == 'MARKER_TAG':
            tag = value
        elif key == 'MARKER_ELEMS':
            elements(int(value), [tag])
    if not NODES:
        raise Problem('it has no points (NPOIN=), so it is no mesh of SU2')

def read_bdf(name):
    """Bulk data of Nastran, whose fields are 8 or 16 characters wide or end with a comma. Sets and properties are numbers; names are in comments."""
    with open(name, encoding='latin-1') as file:
        lines = file.read().splitlines()
    # Number of nodes and position of the first, after the name of the card.
    ELEMENTS = {'CTETRA': ('C3D4', 10, 2), 'CHEXA': ('C3D8', 20, 2), 'CPENTA': ('C3D6', 15, 2), 'CPYRAM': ('C3D5', 13, 2), 'CPYRA': ('C3D5', 13, 2),
                'CTRIA3': ('CPS3', 3, 2), 'CTRIAR': ('CPS3', 3, 2), 'CTRIA6': ('CPS3', 6, 2), 'CQUAD4': ('CPS4', 4, 2), 'CQUADR': ('CPS4', 4, 2),
                'CQUAD8': ('CPS4', 8, 2), 'CBAR': ('T2D2', 2, 2), 'CBEAM': ('T2D2', 2, 2), 'CROD': ('T2D2', 2, 2), 'PLOTEL': ('T2D2', 2, 1)}
    property_names, set_names, sets, cards, skipped, unnamed = {}, {}, {}, [], set(), set()
    def note(text, following):
        """Names that preprocessors write into comments."""
        for pattern, names in ((r'HMNAME\s+PROP\w*\s+(\d+)\s*"([^"]*)"', property_names), (r'HMNAME\s+COMP\w*\s+(\d+)\s*"([^"]*)"', component_names),
                               (r'HMSET\s+(\d+)\s+\d+\s*"([^"]*)"', set_names), (r'\s*Femap.* Property\s+(\d+)\s*:\s*(.*)', property_names),
                               (r'\s*Femap.* Group\s+(\d+)\s*:\s*(.*)', set_names), (r'ANSA_NAME_COMMENT;(\d+);P\w+;([^;]*);', property_names),
                               (r'ANSA_NAME_COMMENT;(\d+);SET;([^;]*);', set_names)):
            found = re.match(pattern, text)
            if found:
                names[int(found[1])] = found[2].strip()
        region = re.match(r'\s*Elements and Element Properties for region\s*:\s*(.*)', text)
        card = re.match(r'P\w+[\s,*]+(\d+)', following)
        if region and card:
            property_names[int(card[1])] = region[1].strip()
    component_names = {}
    bulk = not any(re.match(r'\s*BEGIN\s+BULK', line, re.I) for line in lines)
    rows = iter(enumerate(lines))
    for i, line in rows:
        if line.startswith('$'):
            note(line[1:], lines[i + 1] if i + 1 < len(lines) else '')
        line = line.split('$')[0].expandtabs(8).rstrip()
        given = re.match(r'\s*SET\s+(\d+)\s*=\s*(.*)', line, re.I)
        if given:
            words = given[2]
            while words.endswith(','):
                words += next(rows, (0, ''))[1].split('$')[0].strip() or ' '
            sets[int(given[1])] = words.upper().replace(',', ' ').split()
        elif re.match(r'\s*(BEGIN\s+BULK|ENDDATA)', line, re.I):
            bulk = line.split()[0].upper() == 'BEGIN'
        elif re.match(r'\s*INCLUDE', line, re.I):
            raise Problem('it includes other files; write the mesh into one file')
        elif bulk and line:
            fields = [word.strip() for word in line.split(',')] if ',' in line else [line[:8].strip()]
            width = 16 if '*' in fields[0] else 8
            n = 64 // width
            fields = fields[:n + 1] if ',' in line else fields + [line[8 + width * k:8 + width * (k + 1)].strip() for k in range(n)]
            fields += [''] * (n + 1 - len(fields))
            if fields[0][:1] in ('', '+', '*') and cards:
                cards[-1] += fields[1:]
            else:
                cards.append([fields[0].strip('* ').upper()] + fields[1:])
    real = lambda word: float(re.sub(r'(?<=[\d.])E?([+-])', r'E\1', word.upper().replace('D', 'E'))) if word else 0.0
    place = {}
    for head, *data in cards:
        if head == 'GRID':
            if data[1] not in ('', '0'):
                raise Problem('node %s is in the coordinate system %s; write all nodes in the basic one' % (data[0], data[1]))
            NODES[int(data[0])] = [real(word) for word in data[2:5]]
        elif head in ELEMENTS:
            family, n, first = ELEMENTS[head]
            nodes = [int(word) for word in data[first:first + n] if word]
            title = ''
            if first == 2:
                number = int(data[1] or data[0])
                title = property_names.get(number) or component_names.get(number) or 'property_%d' % number
                BLOCKS.add(title)
                unnamed.update([title] if title == 'property_%d' % number else [])
            if len(nodes) < SHAPES[family][1]:
                raise Problem('%s %s has %d nodes' % (head, data[0], len(nodes)))
            place[int(data[0])] = cell(family, nodes, [title] if title else [])
        elif head in ('SET1', 'SET3'):
            sets[int(data[0])] = [word.upper() for word in data[1 if head == 'SET1' else 2:] if word]
        elif re.match('C(?!ORD)|R(BE|BAR|ROD)', head):
            leave("cards '%s' are not read" % head)
        else:
            skipped.add(head)
    if not NODES:
        raise Problem('it has no nodes (GRID), so it is no bulk data of Nastran or not of a mesh')
    for number, words in sets.items():
        members, title = set(), set_names.get(number) or 'set_%d' % number
        try:
            for word, before, after in zip(words, [''] + words, words[1:] + ['']):
                if word == 'THRU':
                    members.update(range(int(before), int(after) + 1))
                elif word not in ('ALL', 'EXCEPT', 'ELEM', 'GRID'):
                    members.add(int(word))
        except ValueError:
            members = set()
        faces = [k for k in members if k in place]
        if 'EXCEPT' in words or not members:
            leave("sets such as '%s' are not read" % title)
        elif len(faces) > sum(k in NODES for k in members) or faces and all(SHAPES[CELLS[place[k]][0]][0] < 3 for k in faces):
            for k in faces:
                CELLS[place[k]][2].append(title)
            unnamed.update([title] if title == 'set_%d' % number else [])
        else:
            SETS[title] = sorted(members)
            unnamed.update([title] if title == 'set_%d' % number else [])
    if unnamed:
        say('properties and sets without a name in a comment are called by their number: ' + ', '.join(sorted(unnamed)))
    if skipped:
        say('only the mesh is read; skipped: ' + ', '.join(sorted(skipped)))

def deck_of(name):
    """The cells and groups that were read, as a deck."""
    if not CELLS:
        raise Problem('it has no elements that can be read')
    dim = max(SHAPES[family][0] for family, _, _ in CELLS)
    faces, cells = {}, []
    for family, corners, groups in CELLS:
        # A face may be listed by several sets, and by an element of its own.
        known = faces.setdefault(frozenset(corners), groups) if SHAPES[family][0] < dim else groups
        if known is groups:
            cells.append((family, corners, groups))
        else:
            known += [group for group in groups if group not in known]
    size, used, plain, deck = {}, set(), {}, Deck(name)
    for _, _, groups in cells:
        for group in groups:
            size[group] = size.get(group, 0) + 1
    for group in sorted(set(size) | set(SETS), key=str):
        word = ''.join('_' if c in ',=*".\'' or ord(c) < 32 else c for c in group).strip() or 'unnamed'
        word = next(w for w in itertools.chain([word], ('%s_%d' % (word, k) for k in itertools.count(2))) if w.upper() not in used)
        used.add(word.upper())
        plain[group] = word
        if word != group:
            say("'%s' is called '%s' here" % (group, word))
    deck.points = {label: [float(v) for v in x] + [0.0] * (3 - len(x)) for label, x in NODES.items()}
    kept = set()
    for number, (family, corners, groups) in enumerate(cells, 1):
        is_face = SHAPES[family][0] < dim
        group = min(groups, key=lambda g: (is_face and g in BLOCKS, size[g], g)) if groups else ''
        kept.add(group)
        deck.elements.append((number, '%s: element %d' % (name, number), family, corners, plain.get(group, '')))
        if group:
            deck.element_sets.at(plain[group]).add(number)
    for group, nodes in SETS.items():
        deck.node_sets[key_of(plain[group])] = one = Set(plain[group], True)
        for node in nodes:
            one.add(node)
    lost = sorted(group for group in size if group not in kept)
    if lost:
        say('all cells or faces of these groups are in sets or smaller groups, which name them: ' + ', '.join(lost))
    if second:
        say('%d elements of second order are reduced to their corners; compensate with about half the element size' % second)
    for what, n in LEFT.items():
        say('%d %s' % (n, what), 'warning')
    return deck

FILE, RESULT, NAME = sys.argv[1:]
sys.setrecursionlimit(4000)  # sets of sets
try:
    kind = FILE.rsplit('.', 1)[-1].lower()
    if kind != 'inp':
        {'unv': read_unv, 'med': read_med, 'su2': read_su2, 'bdf': read_bdf, 'nas': read_bdf}.get(kind, read_exodus)(FILE)
    Mesh(Reader(FILE, NAME).read() if kind == 'inp' else deck_of(NAME)).write(RESULT)
except Problem as problem:
    print(problem if problem.is_placed else "Cannot read the mesh '%s': %s." % (NAME, problem))
    sys.exit(1)
except Exception as fault:
    print("Cannot read the mesh '%s': it is damaged or written in an unknown way (%s: %s)." % (NAME, type(fault).__name__, fault))
    sys.exit(1)
