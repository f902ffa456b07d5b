# SPDX-License-Identifier: Apache-2.0
"""Reads nodes, elements, sets, surfaces and sections of an input deck of CalculiX or Abaqus (.inp). First part of the script that to_msh.py describes."""
import itertools, math, os, sys
# Families of elements: dimension, faces S1, S2, ... by corners from 0, and type in a .msh.
KINDS = {'C3D4': (3, 4, ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)), 4),
         'C3D8': (3, 8, ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)), 5),
         'C3D6': (3, 6, ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)), 6),
         'C3D5': (3, 5, ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)), 7),
         'CPS3': (2, 3, ((0, 1), (1, 2), (2, 0)), 2), 'CPS4': (2, 4, ((0, 1), (1, 2), (2, 3), (3, 0)), 3), 'T2D2': (1, 2, (), 1)}
SECOND = {'C3D10': 'C3D4', 'C3D20': 'C3D8', 'C3D15': 'C3D6', 'CPS6': 'CPS3', 'CPS8': 'CPS4'}
BARS = {'T2D2': 2, 'T2D3': 3, 'T3D2': 2, 'T3D3': 3, 'B21': 2, 'B22': 3, 'B31': 2, 'B32': 3, 'B31R': 2, 'B32R': 3}
POINTS = ('MASS', 'SPRINGA', 'SPRING1', 'SPRING2', 'DASHPOTA', 'GAPUNI', 'ROTARYI')  # no part of a mesh
REFUSED = {'NGEN': 'it generates nodes', 'NFILL': 'it generates nodes', 'NCOPY': 'it generates nodes', 'NMAP': 'it transforms nodes',
           'SYSTEM': 'it transforms nodes', 'ELGEN': 'it generates elements', 'ELCOPY': 'it generates elements', 'SUBMODEL': 'it is not a mesh',
           'IMPORT': 'it reads another file', 'MANIFEST': 'it reads other files'}
CONNECTING = ('TIE', 'EQUATION', 'MPC', 'RIGID BODY', 'COUPLING', 'CONTACT PAIR', 'CONTACT', 'SHELL TO SOLID COUPLING', 'EMBEDDED ELEMENT', 'MODEL CHANGE')
MOST_MEMBERS, MOST_VISITS, MOST_NESTED = 2000000, 50000000, 1000  # sets of sets could grow without bound
class Problem(Exception):
    """Why a mesh cannot be read. `place`: file and line, without which the caller names the file."""
    def __init__(self, what, place=''):
        super().__init__((place + ': ' if place else '') + what)
        self.is_placed = bool(place)
def say(text, kind='info', place=''):
    print(kind + ':', ' '.join(str(text if place else "'%s': %s." % (NAME, text)).split()))
def beginning(words):
    return ', '.join(list(words)[:20] + (['%d more' % (len(words) - 20)] if len(words) > 20 else []))
def key_of(name):
    """Abaqus writes the instance before the name of a set: Part-1-1.top."""
    return name.rsplit('.', 1)[-1].upper()
def whole(word):
    word = word.strip()
    return int(word) if word.isdigit() and word.isascii() and 0 < int(word) < 2**31 else 0

class Set:
    def __init__(self, name, is_given=False):
        self.name, self.is_given, self.listed, self.generated, self.sets = name, is_given, [], [], []
    def all(self):
        return itertools.chain(self.listed, self.generated)
    def add(self, number):
        """Extends the last range, or begins a new one and returns 1."""
        follows = self.listed and self.listed[-1].stop == number
        if follows:
            self.listed[-1] = range(self.listed[-1].start, number + 1)
        else:
            self.listed.append(range(number, number + 1))
        return not follows

class Sets(dict):
    """Sets by their names in capitals, in the order of the file."""
    def at(self, name):
        return self.setdefault(key_of(name), Set(name.rsplit('.', 1)[-1]))

class Deck:
    def __init__(self, name):
        self.name, self.points = name, {}   # coordinates by the number of the node
        self.elements = []                  # number, place, family, corners, set of its *ELEMENT
        self.node_sets, self.element_sets = Sets(), Sets()
        self.surfaces, self.sections = [], []  # (name, [(set, face, place)], set of nodes); sets
        self.skipped, self.connections, self.others, self.second = set(), set(), {}, 0

class Reader:
    def __init__(self, file, name):
        self.folder, self.deck, self.files, self.opened = os.path.dirname(os.path.realpath(file)), Deck(name), [], 0
        self.line, self.members, self.surface_names, self.parts, self.instances = '', 0, set(), 0, 0
        self.open(file, name)
    def open(self, file, name):
        with open(file, encoding='utf-8', errors='surrogateescape') as text:
            self.files.append([name, iter(text.read().split('\n')), 0])
        self.opened += 1
    def place(self):
        return '%s:%d' % (self.files[-1][0], self.files[-1][2])
    def fail(self, what, place=''):
        raise Problem(what, place or self.place())
    def next(self):
        """Reads the next line of a keyword or of data; at the end of all files there is none."""
        while True:
            file = self.files[-1]
            line = next(file[1], None)
            if line is None:
                if len(self.files) == 1:
                    self.line = ''
                    return False
                self.files.pop()
                continue
            file[2] += 1
            line = line.strip()
            if not line or line == '*' or line.startswith('**'):
                continue
            if '\0' in line:
                self.fail('this is no text')
            self.line = line
            if line[0] != '*' or line[1:].split(',')[0].strip().upper() != 'INCLUDE':
                return True
            self.include(self.keyword()[1].get('INPUT', ''))
    def data(self):
        return self.next() and self.line[0] != '*'
    def include(self, name):
        if not name:
            self.fail('INPUT=... names no file to include.')
        if len(self.files) >= 8 or self.opened >= 1000:
            self.fail('*INCLUDE is nested deeper than 8 files, or there are more than 1000 of them.')
        file = os.path.realpath(os.path.join(self.folder, name))
        if not file.startswith(self.folder.rstrip('/') + '/'):
            self.fail("*INCLUDE '%s' is outside the folder of the mesh '%s'. Move it there, or insert its content into the file." % (name, self.folder))
        if not os.path.isfile(file):
            self.fail("*INCLUDE: '%s' is a folder; name the file in it." % file if os.path.isdir(file) else
                      "*INCLUDE: '%s' is not a regular file." % file if os.path.exists(file) else "*INCLUDE: the file '%s' does not exist." % file)
        self.open(file, file)
    def keyword(self):
        text = self.line[1:]
        while text.endswith(','):
            if len(text) > 1 << 14 or not self.data():
                self.fail('this keyword line ends with a comma, but does not continue.')
            text += self.line
        pieces = text.split('"')
        if len(pieces) % 2 == 0:
            self.fail('unclosed quotation mark.')
        cells = '"'.join(piece.replace(',', '\0') if i % 2 == 0 else piece for i, piece in enumerate(pieces)).split('\0')
        word = ' '.join(cells[0].upper().split())
        if not word:
            self.fail("'*' without a keyword.")
        values = {}
        for cell in cells[1:]:
            name, _, value = (part.strip() for part in cell.partition('='))
            if name:
                values.setdefault(name.upper(), value[1:-1] if len(value) > 1 and value[0] == value[-1] == '"' else value)
        return word, values
    def required(self, word, values, name):
        return values.get(name) or self.fail('*%s needs %s=...' % (word, name))
    def accept(self, word, values, read):
        for name in values:
            if name != 'INPUT' and name not in read:
                say('%s: the parameter %s of *%s is not read.' % (self.place(), name[:40], word), 'warning', self.place())
        if 'INPUT' in values:
            self.include(values['INPUT'])
    def numbers(self, n):
        """Whole numbers of this line and, up to n, of the following ones."""
        found, place = [], self.place()
        while True:
            for word in self.line.split(','):
                if word and not word.isspace():
                    found.append(whole(word) or self.fail("'%s' is not a valid node or element number (whole, above 0, below 2^31)." % word.strip()[:60]))
            if len(found) >= n:
                return found
            if not self.data():
                self.fail('expected %d whole numbers here, found %d.' % (n, len(found)), place)
    def real(self, word):
        word = word.strip()
        plain = word.upper().replace('D', 'E', 1)
        try:
            value = float(plain) if word.isascii() and '_' not in word else None
        except ValueError:
            value = None
        if value is None or not math.isfinite(value):
            self.fail("'%s' is %s" % (word, 'not a number' if value is None else 'beyond the range of numbers' if any(c.isdigit() for c in word) else
                                      'not a finite number'))
        return value

    def read(self):
        if self.next() and self.line[0] != '*':
            self.fail("an input deck must begin with a keyword ('*NODE', ...).")
        treat = {'NODE': self.nodes, 'ELEMENT': self.read_elements, 'NSET': self.node_set, 'ELSET': self.element_set, 'SURFACE': self.surface,
                 'SOLID SECTION': self.section, 'PART': self.part, 'INSTANCE': self.instance}
        while self.line:
            word, values = self.keyword()
            if word in REFUSED:
                self.fail('*%s is not supported: %s. Export the mesh with all nodes and elements written out.' % (word, REFUSED[word]))
            if word not in treat:
                (self.deck.connections if word in CONNECTING else self.deck.skipped).add('*' + word[:40])
            treat.get(word, self.skip)(word, values)
        for sets in (self.deck.node_sets, self.deck.element_sets):
            for one in list(sets.values()):
                self.resolve(one, sets)
        for _, parts, nodes in self.deck.surfaces:
            self.resolve(nodes, self.deck.node_sets)
            for part, _, _ in parts:
                self.resolve(part, self.deck.element_sets)
        for section in self.deck.sections:
            self.resolve(section, self.deck.element_sets)
            section.name = self.deck.element_sets.at(section.name).name
        return self.deck
    def skip(self, word='', values=None):
        while self.data():
            pass
    def part(self, word, values):
        self.parts += 1
        if self.parts > 1:
            self.fail("decks with several parts are not supported. Export it flat (Abaqus: 'do not use parts and assemblies').")
        self.skip()
    def instance(self, word, values):
        self.instances += 1
        if self.instances > 1:
            self.fail("decks with several instances are not supported. Export it flat (Abaqus: 'do not use parts and assemblies').")
        if self.data():
            self.fail('transformed instances are not supported. Export the deck flat.')
    def nodes(self, word, values):
        if values.get('SYSTEM', 'R').upper() != 'R':
            self.fail('*NODE is supported in rectangular coordinates only.')
        self.accept(word, values, ('NSET', 'SYSTEM'))
        own, points = self.deck.node_sets.at(values['NSET']) if 'NSET' in values else None, self.deck.points
        while self.data():
            words = self.line.rstrip(', \t').split(',')
            label = whole(words[0])
            if not label or len(words) > 7:
                self.fail("a node needs a whole number above 0 and up to three coordinates: '12, 0.5, 1, 0'.")
            if label in points:
                self.fail('node %d is defined twice.' % label)
            x = [self.real(word) if word.strip() else 0.0 for word in words[1:4]]
            points[label] = x + [0.0] * (3 - len(x))
            if own:
                self.add(own, label)
    def read_elements(self, word, values):
        name = self.required(word, values, 'TYPE').upper()
        family, n = self.family_of(name)
        self.accept(word, values, ('TYPE', 'ELSET'))
        own = self.deck.element_sets.at(values['ELSET']) if values.get('ELSET') else None
        if not n:
            self.deck.skipped.add(name)
            while self.data():
                self.deck.others[whole(self.line.split(',')[0])] = 0
            return
        kept, group = KINDS[family][1] + 1, own.name if own else ''
        while self.data():
            place, found = self.place(), self.numbers(n + 1)
            if len(found) != n + 1:
                self.fail('a %s needs its number and %d nodes; found %d numbers.' % (name, n, len(found)))
            self.deck.elements.append((found[0], place, family, tuple(found[1:kept]), group))
            self.deck.second += n >= kept and family != 'T2D2'
            if own:
                self.add(own, found[0])
    def family_of(self, name):
        """Family and number of nodes; 0 nodes for elements that are no part of a mesh."""
        if name in BARS or name in POINTS:
            return 'T2D2', BARS.get(name, 0)
        kind = name[1:] if name.startswith('DC') else name  # elements of heat
        plain = ('CPS' + kind[3:] if kind.startswith(('CPE', 'CAX', 'C2D')) else kind).rstrip('RHIMST')
        n = plain[3:] if plain[:3] in ('C3D', 'CPS') else ''
        family = SECOND.get(plain, plain)
        if n.isdigit() and family in KINDS:
            return family, int(n)
        reason = ('shells and membranes are not supported; mesh the wall as a solid' if name.startswith(('S3', 'S4', 'S6', 'S8', 'STRI', 'SC', 'M3D')) else
                  'it is not a solid element' if name.startswith(('AC', 'F', 'U')) else 'it is unknown')
        self.fail("elements of type '%s' are not supported (%s). Supported: C3D4, C3D5, C3D6, C3D8, C3D10, C3D15, C3D20, CPS3, CPS4, CPS6, CPS8 and their "
                  'CPE, CAX and DC equivalents; second-order ones by their corners.' % (name[:40], reason))
    def count(self, n=1):
        self.members += n
        if self.members > MOST_MEMBERS:
            self.fail('the sets of this deck have more than %d members.' % MOST_MEMBERS)
    def add(self, one, number):
        self.count(one.add(number))
    def add_named(self, one, word):
        """A number, or a set that may be defined later."""
        if whole(word):
            return self.add(one, whole(word))
        self.count()
        one.sets.append((word.strip(), self.place()))
    def resolve(self, one, sets, depth=0):
        """Adds the members of the sets that it contains."""
        for name, place in one.sets:
            if depth > MOST_NESTED:
                self.fail('sets contain each other, or are nested deeper than %d.' % MOST_NESTED, place)
            other = sets.get(key_of(name)) or self.fail("'%s' is neither a number nor the name of an %s." % (
                name[:60], 'NSET' if sets is self.deck.node_sets else 'ELSET'), place)
            if other is one:
                continue
            self.resolve(other, sets, depth + 1)
            self.count(len(other.listed) + len(other.generated))
            one.listed += other.listed
            one.generated += other.generated
        for ranges in (one.listed, one.generated) if one.sets else ():
            ranges[:] = sorted(set(ranges), key=lambda r: (r.start, r.stop, r.step))
        one.sets = []
    def node_set(self, word, values):
        if 'ELSET' in values:
            self.fail('*NSET of the nodes of an ELSET is not supported; list the nodes.')
        self.set(word, values, self.deck.node_sets)
    def element_set(self, word, values):
        self.set(word, values, self.deck.element_sets)
    def set(self, word, values, sets):
        one = sets.at(self.required(word, values, word))
        one.is_given = True
        self.accept(word, values, (word, 'GENERATE', 'INSTANCE', 'INTERNAL', 'UNSORTED'))
        while self.data():
            if 'GENERATE' in values:
                found = self.numbers(2)
                if len(found) > 3 or found[1] < found[0]:
                    self.fail("GENERATE needs first, last and step: '1, 100, 3'.")
                one.generated.append(range(found[0], found[1] + 1, found[2] if len(found) > 2 else 1))
                continue
            for cell in self.line.split(','):
                if cell.strip():
                    self.add_named(one, cell)
    def surface(self, word, values):
        name = self.required(word, values, 'NAME')
        if name.upper() in self.surface_names:
            self.fail("the surface '%s' is defined twice." % name[:60])
        self.surface_names.add(name.upper())
        if 'COMBINE' in values or 'CROP' in values:
            self.fail('surfaces composed of other surfaces are not supported; list the faces.')
        kind = values.get('TYPE', 'ELEMENT').upper()
        if kind not in ('ELEMENT', 'NODE'):
            self.fail('surfaces of TYPE=%s are not supported; use ELEMENT or NODE.' % kind[:40])
        self.accept(word, values, ('NAME', 'TYPE', 'INTERNAL'))
        parts, nodes = [], Set(name, True)
        while self.data():
            cells = self.line.split(',')
            if kind == 'NODE':
                self.add_named(nodes, cells[0])
                continue
            face = cells[1].strip().upper() if len(cells) > 1 else ''
            if len(face) != 2 or face[0] != 'S' or face[1] not in '123456':
                self.fail("expected a face of an element or of an ELSET, such as 'beam, S3', not '%s'." % self.line[:60])
            parts.append((Set(name, True), int(face[1]) - 1, self.place()))
            self.add_named(parts[-1][0], cells[0])
        self.deck.surfaces.append((name, parts, nodes))
    def section(self, word, values):
        name = self.required(word, values, 'ELSET')
        self.deck.sections.append(Set(name.rsplit('.', 1)[-1]))
        self.deck.sections[-1].sets.append((name, self.place()))
        self.skip()
