// SPDX-License-Identifier: Apache-2.0
// An L-bracket, legs of 100 mm, 20 mm thick and 30 mm deep, with a fillet of radius r; cells of size h.
SetFactory("OpenCASCADE");
DefineConstant [ h = 0.006, r = 0.01 ];
t = 0.02; L = 0.1;
Point(1) = {0, 0, 0}; Point(2) = {L, 0, 0}; Point(3) = {L, t, 0}; Point(4) = {t + r, t, 0};
Point(5) = {t, t + r, 0}; Point(6) = {t, L, 0}; Point(7) = {0, L, 0}; Point(8) = {t + r, t + r, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Circle(4) = {4, 8, 5};
Line(5) = {5, 6}; Line(6) = {6, 7}; Line(7) = {7, 1};
Curve Loop(1) = {1:7}; Plane Surface(1) = {1};
Transfinite Curve{4} = Ceil(1.5708 * r / h * 2) + 1;
e[] = Extrude {0, 0, 0.03} { Surface{1}; };
Physical Volume("bracket") = {e[1]};
Physical Surface("front") = {1, e[0]};
Physical Surface("foot") = {e[2]};
Physical Surface("end") = {e[3]};
Physical Surface("top") = {e[4]};
Physical Surface("fillet") = {e[5]};
Physical Surface("inner") = {e[6]};
Physical Surface("clamp") = {e[7]};
Physical Surface("back") = {e[8]};
Mesh.CharacteristicLengthMax = h;
Mesh.CharacteristicLengthMin = h / 4;
Mesh.Optimize = 1;
