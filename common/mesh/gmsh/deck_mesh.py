# SPDX-License-Identifier: Apache-2.0
"""From the sets of a deck to patches and zones, and to a .msh. Second part of the script that to_msh.py describes; deck.py precedes it."""
class Mesh:
    """Cells, zones and patches of a deck. A boundary face has the patch of a surface, of an element with a set, or of the smallest set with all its nodes."""
    def __init__(self, deck):
        self.deck, self.visits, self.inner, self.lost = deck, 0, 0, []
        self.dim = 3 if any(KINDS[e[2]][0] == 3 for e in deck.elements) else 2
        self.cells = [e for e in deck.elements if KINDS[e[2]][0] == self.dim]
        if not self.cells:
            raise Problem('the deck has no solid elements (C3D4, C3D8, CPS4, ...).', deck.name)
        deck.others.update((e[0], 0) for e in deck.elements if KINDS[e[2]][0] < self.dim)
        self.cell_of = {}
        for c, (number, place, family, corners, _) in enumerate(self.cells):
            if self.cell_of.setdefault(number, c) != c:
                raise Problem('element %d is defined twice.' % number, place)
            for corner in corners:
                if corner not in deck.points:
                    raise Problem('element %d has node %d, which the deck does not define.' % (number, corner), place)
            if len(set(corners)) < len(corners):
                twice = next(corner for i, corner in enumerate(corners) if corner in corners[:i])
                raise Problem('element %d has node %d twice. Degenerate cells are not supported; use a C3D6, C3D5 or C3D4.' % (number, twice), place)
        self.name_missing()
        used = set(itertools.chain.from_iterable(e[3] for e in self.cells))  # others are midside or reference nodes
        self.point_of = {label: i for i, label in enumerate(label for label in deck.points if label in used)}
        self.find_zones()
        self.find_outer()
        self.patch_names, self.patch_of = {}, {}  # by the name in capitals; by the face
        for surface in deck.surfaces:
            self.take_surface(*surface)
        self.take_flat_elements()
        self.take_node_sets()
        self.name_rest()
        self.report()
    def visit(self, ranges, index):
        """Members that exist, as often as they are named. A crafted deck may name too many."""
        for members in ranges:
            self.visits += min(len(members), len(index)) + 1
            if self.visits > MOST_VISITS:
                raise Problem('the sets of this deck have too many members.', self.deck.name)
            for number in members if len(members) <= len(index) else [number for number in index if number in members]:
                if number in index:
                    yield index[number]
    def name_missing(self):
        """Names sets with listed members that the deck does not define."""
        deck, found = self.deck, []
        def check(kind, name, ranges, *indices):
            missing = [number for members in ranges for number in members if not any(number in index for index in indices)]
            if missing:
                found.append("%d of %d of %s '%s' (the first is %d)" % (len(missing), sum(map(len, ranges)), kind, name, missing[0]))
        for one in deck.node_sets.values():
            if one.is_given:
                check('NSET', one.name, one.listed, deck.points)
        for one in deck.element_sets.values():
            if one.is_given:
                check('ELSET', one.name, one.listed, self.cell_of, deck.others)
        for name, parts, nodes in deck.surfaces:
            check('SURFACE', name, nodes.listed, deck.points)
            check('SURFACE', name, [members for part, _, _ in parts for members in part.listed], self.cell_of, deck.others)
        if found:
            say('members of sets are not defined in the deck: ' + beginning(found), 'warning')
    def find_zones(self):
        """By *SOLID SECTION, else by the set of the *ELEMENT."""
        self.zone_of, self.zones = [None] * len(self.cells), {}
        names = self.zones
        for section in self.deck.sections:
            name = names.setdefault(section.name.upper(), section.name)
            for c in self.visit(section.all(), self.cell_of):
                if self.zone_of[c] not in (None, name):
                    raise Problem("element %d has two sections, '%s' and '%s'." % (self.cells[c][0], self.zone_of[c], name), self.cells[c][1])
                self.zone_of[c] = name
        for c, cell in enumerate(self.cells):
            if self.zone_of[c] is None:
                self.zone_of[c] = names.setdefault((cell[4] or 'default').upper(), cell[4] or 'default')
    def find_outer(self):
        """Points of each boundary face by its sorted points. Faces between two cells have none."""
        self.outer, self.points, point_of, outer = {}, [], self.point_of, None
        outer = self.outer
        for _, _, family, corners, _ in self.cells:
            points = [point_of[corner] for corner in corners]
            self.points.append(points)
            for face in KINDS[family][2]:
                own = [points[k] for k in face]
                key = tuple(sorted(own))
                outer[key] = None if key in outer else own
    def name_of(self, name):
        return self.patch_names.setdefault(name.upper(), name)
    def assign(self, key, patch):
        known = self.patch_of.setdefault(key, patch)
        if known != patch:
            labels = list(self.point_of)
            mean = [sum(self.deck.points[labels[p]][a] for p in key) / len(key) for a in range(self.dim)]
            raise Problem("the boundary face at (%s) is in two surfaces, '%s' and '%s'. Every boundary face must be in exactly one." % (
                ', '.join('%.6g' % x for x in mean), known, patch), self.deck.name)
    def take_surface(self, name, parts, nodes):
        patch = self.name_of(name)
        for part, face, place in parts:
            for c in self.visit(part.all(), self.cell_of):
                faces = KINDS[self.cells[c][2]][2]
                if face >= len(faces):
                    raise Problem("surface '%s': element %d has faces S1 to S%d only." % (name, self.cells[c][0], len(faces)), place)
                key = tuple(sorted(self.points[c][k] for k in faces[face]))
                if self.outer[key]:
                    self.assign(key, patch)
                else:
                    self.inner += 1
        if nodes.listed or nodes.generated:
            self.take_nodes(nodes, patch, True)
    def take_flat_elements(self):
        """Lower-dimensional elements, as meshers write them for groups of surfaces: by their smallest *ELSET, else by that of their *ELEMENT."""
        face_of = {}
        for number, _, family, corners, _ in self.deck.elements:
            if KINDS[family][0] == self.dim - 1 and all(corner in self.point_of for corner in corners):
                key = tuple(sorted(self.point_of[corner] for corner in corners))
                self.inner += face_of.setdefault(number, key if self.outer.get(key) else None) is None
        if not face_of:
            return
        by_size, sets = [], self.deck.element_sets.values()
        # Sets beside elements are named where there are no others, for gmsh writes one for each surface.
        are_named = not any(one.is_given for one in sets)
        for one in sets:
            faces = list(self.visit(one.all(), face_of))
            n = sum(face is not None for face in faces)
            if n:
                by_size.append((n if one.is_given else n + len(face_of), one))
            elif faces and (one.is_given or are_named):
                self.lost.append(one.name)
        for _, one in sorted(by_size, key=lambda pair: pair[0]):
            keys = [key for key in self.visit(one.all(), face_of) if key is not None and key not in self.patch_of]
            for key in keys:
                self.patch_of.setdefault(key, self.name_of(one.name))
            if not keys and (one.is_given or are_named):
                self.lost.append(one.name)
    def take_node_sets(self):
        """Smaller ones first. A set of all points, or with the name of a surface, names nothing."""
        by_size = []
        for one in self.deck.node_sets.values():
            n = len(set(self.visit(one.all(), self.point_of)))
            if 2 <= n < len(self.point_of) and one.name.upper() not in self.patch_names:
                by_size.append((n, one))
        for _, one in sorted(by_size, key=lambda pair: pair[0]):
            self.take_nodes(one, self.name_of(one.name), False)
    def take_nodes(self, one, patch, is_surface):
        """Assigns the faces whose points are all in this set."""
        if not hasattr(self, 'faces_of'):
            self.faces_of = {}
            for key, points in self.outer.items():
                for p in key if points else ():
                    self.faces_of.setdefault(p, []).append(key)
        marked = set(self.visit(one.all(), self.point_of))
        for p in marked:
            for key in self.faces_of.get(p, ()):
                if marked.issuperset(key) and (is_surface or key not in self.patch_of):
                    self.assign(key, patch)
    def name_rest(self):
        for key, points in self.outer.items():
            if points:
                self.patch_of.setdefault(key, 'rest')
        kept = set(self.patch_of.values())
        self.lost += [name for name in self.patch_names.values() if name not in kept]
        self.patches = [name for name in self.patch_names.values() if name in kept and name != 'rest'] + (['rest'] if 'rest' in kept else [])
        if self.lost:
            say('these name no patch, since no boundary face is left for them: ' + beginning(self.lost))
    def report(self):
        deck = self.deck
        if deck.second:
            say('%d second-order elements are reduced to their corners; compensate with about half the element size' % deck.second)
        if self.inner:
            say('%d faces of surfaces lie between two cells and belong to no patch' % self.inner)
        if deck.skipped:
            say('only the mesh is read; skipped: ' + beginning(sorted(deck.skipped)))
        if deck.connections:
            say('parts of the mesh are connected by %s, which is not read' % beginning(sorted(deck.connections)), 'warning')
    def write(self, name):
        used = set(self.zone_of)
        zones = [name for name in self.zones.values() if name in used]
        numbers = [{name: i for i, name in enumerate(names, 1)} for names in (self.patches, zones)]
        with open(name, 'w', encoding='utf-8', errors='surrogateescape') as file:
            file.write('$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n%d\n' % sum(map(len, numbers)))
            for dim, names in zip((self.dim - 1, self.dim), numbers):
                file.writelines('%d %d "%s"\n' % (dim, i, one) for one, i in names.items())
            file.write('$EndPhysicalNames\n$Nodes\n%d\n' % len(self.point_of))
            file.writelines('%d %r %r %r\n' % (i + 1, *self.deck.points[label]) for label, i in self.point_of.items())
            faces = [(points, numbers[0][self.patch_of[key]]) for key, points in self.outer.items() if points]
            file.write('$EndNodes\n$Elements\n%d\n' % (len(self.cells) + len(faces)))
            kinds = {2: 1, 3: 2, 4: 3}  # types of faces by their number of points
            rows = itertools.chain(((kinds[len(points)], patch, points) for points, patch in faces),
                                   ((KINDS[e[2]][3], numbers[1][zone], points) for e, zone, points in zip(self.cells, self.zone_of, self.points)))
            file.writelines('%d %d 2 %d %d %s\n' % (i, kind, tag, tag, ' '.join([str(p + 1) for p in points])) for i, (kind, tag, points) in enumerate(rows, 1))
            file.write('$EndElements\n')
