// SPDX-License-Identifier: Apache-2.0
// A cube of hexahedra, on it a cube of tetrahedra (pyramids on the quadrilaterals between), beside that half a cube of prisms.
Point(1) = {0, 0, 0, 0.6}; Point(2) = {1, 0, 0, 0.6}; Point(3) = {1, 1, 0, 0.6}; Point(4) = {0, 1, 0, 0.6};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve {1, 2, 3, 4} = 3; Transfinite Surface {1}; Recombine Surface {1};
up[] = Extrude {0, 0, 1} { Surface{1}; Layers{2}; Recombine; };
// tetrahedra on top
top = up[0];
Point(101) = {0, 0, 2, 0.6}; Point(102) = {1, 0, 2, 0.6}; Point(103) = {1, 1, 2, 0.6}; Point(104) = {0, 1, 2, 0.6};
e[] = Boundary{ Surface{top}; };
p0[] = Boundary{ Line{Abs(e[0])}; };
p2[] = Boundary{ Line{Abs(e[2])}; };
Line(101) = {101, 102}; Line(102) = {102, 103}; Line(103) = {103, 104}; Line(104) = {104, 101};
Line(111) = {p0[0], 101}; Line(112) = {p0[1], 102}; Line(113) = {p2[0], 103}; Line(114) = {p2[1], 104};
Curve Loop(101) = {101, 102, 103, 104}; Plane Surface(101) = {101};
Curve Loop(102) = {e[0], 112, -101, -111}; Plane Surface(102) = {102};
Curve Loop(103) = {e[1], 113, -102, -112}; Plane Surface(103) = {103};
Curve Loop(104) = {e[2], 114, -103, -113}; Plane Surface(104) = {104};
Curve Loop(105) = {e[3], 111, -104, -114}; Plane Surface(105) = {105};
Surface Loop(101) = {top, 101, 102, 103, 104, 105}; Volume(101) = {101};
// prisms beside the tetrahedra
out[] = Extrude {0.5, 0, 0} { Surface{103}; Layers{1}; Recombine; };
Physical Volume("lower") = {up[1]};
Physical Volume("upper") = {101, out[1]};
Physical Surface("bottom") = {1};
Physical Surface("top") = {101};
Physical Surface("sides") = {up[2], up[3], up[4], up[5], 102, 104, 105, out[0], out[2], out[3], out[4], out[5]};
