// SPDX-License-Identifier: Apache-2.0
// A bar of 200 x 40 x 20 mm with a hole of 20 mm for a pin, 30 mm from its end; triangles extruded to prisms.
DefineConstant [ h = 5, layers = 4 ];
L = 200; H = 20; c = 170; r = 10; thick = 20; // mm
Point(1) = {0, -H, 0, h}; Point(2) = {L, -H, 0, h}; Point(3) = {L, H, 0, h}; Point(4) = {0, H, 0, h};
Point(5) = {c, 0, 0, h}; Point(6) = {c + r, 0, 0, h / 2}; Point(7) = {c, r, 0, h / 2}; Point(8) = {c - r, 0, 0, h / 2}; Point(9) = {c, -r, 0, h / 2};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Circle(5) = {6, 5, 7}; Circle(6) = {7, 5, 8}; Circle(7) = {8, 5, 9}; Circle(8) = {9, 5, 6};
Curve Loop(1) = {1, 2, 3, 4}; Curve Loop(2) = {5, 6, 7, 8};
Plane Surface(1) = {1, 2};
out[] = Extrude {0, 0, thick} { Surface{1}; Layers{layers}; Recombine; };
Physical Volume("bar") = {out[1]};
Physical Surface("back") = {1};
Physical Surface("front") = {out[0]};
Physical Surface("bottom") = {out[2]};
Physical Surface("end") = {out[3]};
Physical Surface("top") = {out[4]};
Physical Surface("clamp") = {out[5]};
Physical Surface("hole") = {out[6], out[7], out[8], out[9]};
