// SPDX-License-Identifier: Apache-2.0
// Two unit squares side by side: quadrilaterals on the left ("stiff"), triangles on the right ("soft").
Point(1) = {0, 0, 0, 0.5}; Point(2) = {1, 0, 0, 0.5}; Point(3) = {2, 0, 0, 0.5};
Point(4) = {2, 1, 0, 0.5}; Point(5) = {1, 1, 0, 0.5}; Point(6) = {0, 1, 0, 0.5};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 1};
Line(7) = {2, 5};
Curve Loop(1) = {1, 7, 5, 6}; Plane Surface(1) = {1};
// Turned the other way round: clockwise cells.
Curve Loop(2) = {7, -4, -3, -2}; Plane Surface(2) = {2};
Transfinite Curve {1, 5, 6, 7} = 3; Transfinite Surface {1}; Recombine Surface {1};
Physical Curve("outlet", 12) = {3};
Physical Curve("inlet", 11) = {6};
Physical Curve("wall") = {1, 2, 4, 5};
Physical Surface("stiff") = {1};
Physical Surface("soft") = {2};
