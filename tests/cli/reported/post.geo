// SPDX-License-Identifier: Apache-2.0
DefineConstant[ n = 20, m = 3 ];
Point(1) = {-0.05,-0.03,0}; Point(2) = {0.05,-0.03,0}; Point(3) = {0.05,0.03,0}; Point(4) = {-0.05,0.03,0};
Line(1)={1,2}; Line(2)={2,3}; Line(3)={3,4}; Line(4)={4,1};
Curve Loop(1)={1,2,3,4}; Plane Surface(1)={1};
Transfinite Curve {1,2,3,4} = m+1; Transfinite Surface {1}; Recombine Surface {1};
out[] = Extrude {0,0,2} { Surface{1}; Layers{n}; Recombine; };
Physical Surface("foot") = {1}; Physical Surface("head") = {out[0]};
Physical Surface("skin") = {out[2],out[3],out[4],out[5]};
Physical Volume("post") = {out[1]};
