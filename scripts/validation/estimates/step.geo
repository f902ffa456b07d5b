// SPDX-License-Identifier: Apache-2.0
// A channel of height 2 whose floor rises by 1 from x = 2 to x = 3 and stays there: an L turned over.
DefineConstant[ n = 4 ];  // cells over a length of 1
Point(1) = {0, 0, 0}; Point(2) = {2, 0, 0}; Point(3) = {2, 1, 0}; Point(4) = {6, 1, 0}; Point(5) = {6, 2, 0}; Point(6) = {2, 2, 0}; Point(7) = {0, 2, 0}; Point(8) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 7}; Line(7) = {7, 8}; Line(8) = {8, 1}; Line(9) = {8, 3}; Line(10) = {3, 6};
Transfinite Curve {1, 6, 9} = 2 * n + 1; Transfinite Curve {3, 5} = 4 * n + 1; Transfinite Curve {2, 4, 7, 8, 10} = n + 1;
Curve Loop(1) = {1, 2, -9, 8}; Curve Loop(2) = {9, 10, 6, 7}; Curve Loop(3) = {3, 4, 5, -10};
For i In {1 : 3}
  Plane Surface(i) = {i}; Transfinite Surface {i}; Recombine Surface {i};
EndFor
Physical Curve("inlet") = {7, 8}; Physical Curve("outlet") = {4}; Physical Curve("walls") = {1, 2, 3, 5, 6}; Physical Surface("inside") = {1 : 3};
