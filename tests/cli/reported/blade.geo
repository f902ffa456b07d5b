// SPDX-License-Identifier: Apache-2.0
DefineConstant[ n = 30, my = 3, mz = 2 ];
Point(1) = {0.4,-0.03,-0.01}; Point(2) = {0.4,0.03,-0.01}; Point(3) = {0.4,0.03,0.01}; Point(4) = {0.4,-0.03,0.01};
Line(1)={1,2}; Line(2)={2,3}; Line(3)={3,4}; Line(4)={4,1};
Curve Loop(1)={1,2,3,4}; Plane Surface(1)={1};
Transfinite Curve {1,3} = my+1; Transfinite Curve {2,4} = mz+1; Transfinite Surface {1}; Recombine Surface {1};
out[] = Extrude {1.2,0,0} { Surface{1}; Layers{n}; Recombine; };
Physical Surface("root") = {1}; Physical Surface("tip") = {out[0]};
Physical Surface("skin") = {out[2],out[3],out[4],out[5]};
Physical Volume("blade") = {out[1]};
