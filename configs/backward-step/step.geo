// SPDX-License-Identifier: Apache-2.0
// Behind a step in a channel of height 1 (Gartling 1990): the inlet is its upper half, the step's face below it is a wall.
DefineConstant[ n = 32, end = 20 ]; // cells over the height; length of the channel
h = 0.5;
Point(1) = {0, -h, 0}; Point(2) = {end, -h, 0}; Point(3) = {0, 0, 0}; Point(4) = {end, 0, 0}; Point(5) = {0, h, 0}; Point(6) = {end, h, 0};
Line(1) = {1, 2}; Line(2) = {3, 4}; Line(3) = {5, 6}; Line(4) = {1, 3}; Line(5) = {3, 5}; Line(6) = {2, 4}; Line(7) = {4, 6};
Curve Loop(1) = {1, 6, -2, -4}; Plane Surface(1) = {1};
Curve Loop(2) = {2, 7, -3, -5}; Plane Surface(2) = {2};
Transfinite Curve{4, 5, 6, 7} = n / 2 + 1 Using Bump 0.4;
Transfinite Curve{1, 2, 3} = Round(end * n / 4) + 1 Using Progression 1 + 0.16 / n;
Transfinite Surface{1, 2}; Recombine Surface{1, 2};
Physical Curve("inlet") = {5};
Physical Curve("step") = {4};
Physical Curve("floor") = {1};
Physical Curve("lid") = {3};
Physical Curve("outlet") = {6, 7};
Physical Surface("fluid") = {1, 2};
