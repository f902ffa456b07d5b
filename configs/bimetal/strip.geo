// SPDX-License-Identifier: Apache-2.0
// A strip of 100 x 2 mm of two layers, in millimeters; n cells across each layer.
DefineConstant [ n = 4 ];
L = 100; h = 1; // mm

Point(1) = {0, 0, 0}; Point(2) = {L, 0, 0};
Point(3) = {0, h, 0}; Point(4) = {L, h, 0};
Point(5) = {0, 2 * h, 0}; Point(6) = {L, 2 * h, 0};
Line(1) = {1, 2}; Line(2) = {3, 4}; Line(3) = {5, 6};
Line(4) = {1, 3}; Line(5) = {3, 5}; Line(6) = {2, 4}; Line(7) = {4, 6};
Transfinite Curve {1 : 3} = 25 * n + 1;
Transfinite Curve {4 : 7} = n + 1;
Curve Loop(1) = {1, 6, -2, -4}; Plane Surface(1) = {1};
Curve Loop(2) = {2, 7, -3, -5}; Plane Surface(2) = {2};
Transfinite Surface {1 : 2};
Recombine Surface {1 : 2};
Physical Curve("clamp") = {4, 5};
Physical Curve("end") = {6, 7};
Physical Curve("bottom") = {1};
Physical Curve("top") = {3};
Physical Surface("steel") = {1};
Physical Surface("nickel-iron") = {2};
