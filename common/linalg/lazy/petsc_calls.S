// SPDX-License-Identifier: Apache-2.0
// What the sources call of PETSc, SLEPc, Scotch and LAPACK. Each name jumps to where its slot points: at first to
// couplet_petsc_call, which opens the libraries and finds the function (what the dynamic linker does with functions bound
// lazily), from then on to the function itself. A name that is called and stands in no line here is an undefined reference
// when a program is linked. x86-64; elsewhere programs are linked to PETSc (COUPLET_LAZY).

.macro lazily name
  .section .rodata
text_\name:
  .asciz "\name"
  .data
  .balign 8
slot_\name:
  .quad first_\name
  .text
  .balign 16
  .globl \name
  .hidden \name
  .type \name, @function
\name:
  endbr64
  jmp *slot_\name(%rip)
first_\name:
  endbr64
  leaq text_\name(%rip), %r10
  leaq slot_\name(%rip), %r11
  jmp find_and_call
  .size \name, . - \name
.endm

  .text
  .balign 16
  .type find_and_call, @function
// Keeps the registers that hold arguments. r10: the name, r11: the slot.
find_and_call:
  .cfi_startproc
  pushq %rbp
  .cfi_def_cfa_offset 16
  .cfi_offset %rbp, -16
  movq %rsp, %rbp
  .cfi_def_cfa_register %rbp
  andq $-16, %rsp
  subq $192, %rsp
  movq %rdi, 0(%rsp)
  movq %rsi, 8(%rsp)
  movq %rdx, 16(%rsp)
  movq %rcx, 24(%rsp)
  movq %r8, 32(%rsp)
  movq %r9, 40(%rsp)
  movq %rax, 48(%rsp)
  movq %r11, 56(%rsp)
  movaps %xmm0, 64(%rsp)
  movaps %xmm1, 80(%rsp)
  movaps %xmm2, 96(%rsp)
  movaps %xmm3, 112(%rsp)
  movaps %xmm4, 128(%rsp)
  movaps %xmm5, 144(%rsp)
  movaps %xmm6, 160(%rsp)
  movaps %xmm7, 176(%rsp)
  movq %r10, %rdi
  call couplet_petsc_call@PLT
  movq 56(%rsp), %r11
  movq %rax, (%r11)
  movq %rax, %r10
  movq 0(%rsp), %rdi
  movq 8(%rsp), %rsi
  movq 16(%rsp), %rdx
  movq 24(%rsp), %rcx
  movq 32(%rsp), %r8
  movq 40(%rsp), %r9
  movq 48(%rsp), %rax
  movaps 64(%rsp), %xmm0
  movaps 80(%rsp), %xmm1
  movaps 96(%rsp), %xmm2
  movaps 112(%rsp), %xmm3
  movaps 128(%rsp), %xmm4
  movaps 144(%rsp), %xmm5
  movaps 160(%rsp), %xmm6
  movaps 176(%rsp), %xmm7
  leave
  .cfi_def_cfa %rsp, 8
  jmp *%r10
  .cfi_endproc
  .size find_and_call, . - find_and_call

lazily EPSComputeError
lazily EPSCreate
lazily EPSDestroy
lazily EPSGetConverged
lazily EPSGetEigenpair
lazily EPSGetST
lazily EPSSetDeflationSpace
lazily EPSSetDimensions
lazily EPSSetOperators
lazily EPSSetProblemType
lazily EPSSetTarget
lazily EPSSetTolerances
lazily EPSSetType
lazily EPSSetWhichEigenpairs
lazily EPSSolve
lazily ISDestroy
lazily ISGetIndices
lazily ISRestoreIndices
lazily KSPCreate
lazily KSPDestroy
lazily KSPGMRESSetCGSRefinementType
lazily KSPGMRESSetRestart
lazily KSPGetConvergedReason
lazily KSPGetIterationNumber
lazily KSPGetPC
lazily KSPGetResidualNorm
lazily KSPMonitorSet
lazily KSPSetInitialGuessNonzero
lazily KSPSetNormType
lazily KSPSetOperators
lazily KSPSetPCSide
lazily KSPSetReusePreconditioner
lazily KSPSetTolerances
lazily KSPSetType
lazily KSPSetUp
lazily KSPSolve
lazily MatAXPY
lazily MatCholeskyFactorNumeric
lazily MatCholeskyFactorSymbolic
lazily MatCreate
lazily MatCreateMPIAdj
lazily MatCreateRedundantMatrix
lazily MatCreateShell
lazily MatCreateVecs
lazily MatDestroy
lazily MatDuplicate
lazily MatFactorGetError
lazily MatFactorInfoInitialize
lazily MatGetFactor
lazily MatGetInertia
lazily MatGetOwnershipRange
lazily MatGetRowIJ
lazily MatGetSize
lazily MatGetValues
lazily MatMult
lazily MatMumpsSetIcntl
lazily MatPartitioningApply
lazily MatPartitioningCreate
lazily MatPartitioningDestroy
lazily MatPartitioningSetAdjacency
lazily MatPartitioningSetNParts
lazily MatPartitioningSetType
lazily MatRestoreRowIJ
lazily MatSeqAIJGetArrayRead
lazily MatSeqAIJRestoreArrayRead
lazily MatSetBlockSize
lazily MatSetOption
lazily MatSetPreallocationCOO
lazily MatSetSizes
lazily MatSetType
lazily MatSetValuesCOO
lazily MatShellGetContext
lazily MatShellSetOperation
lazily MatSolve
lazily PCApply
lazily PCFactorSetMatOrderingType
lazily PCFactorSetMatSolverType
lazily PCHYPRESetType
lazily PCRedundantGetKSP
lazily PCRedundantSetNumber
lazily PCSetFromOptions
lazily PCSetOptionsPrefix
lazily PCSetType
lazily PCShellGetContext
lazily PCShellSetApply
lazily PCShellSetContext
lazily PetscError
lazily PetscErrorMessage
lazily PetscMPIErrorString
lazily PetscMallocA
lazily PetscMallocValidate
lazily PetscObjectComm
lazily PetscOptionsSetValue
lazily SCOTCH_randomReset
lazily STGetKSP
lazily STSetMatMode
lazily STSetType
lazily SlepcFinalize
lazily SlepcInitializeNoArguments
lazily VecAXPY
lazily VecDestroy
lazily VecDuplicate
lazily VecGetArray
lazily VecGetArrayRead
lazily VecGetArrayWrite
lazily VecGetLocalSize
lazily VecNorm
lazily VecPlaceArray
lazily VecResetArray
lazily VecRestoreArray
lazily VecRestoreArrayRead
lazily VecRestoreArrayWrite
lazily VecScatterBegin
lazily VecScatterCreateToAll
lazily VecScatterDestroy
lazily VecScatterEnd
lazily couplet_petsc_reasons
lazily couplet_petsc_start
lazily couplet_petsc_stop
lazily dgeev_
lazily dsygv_

// Data cannot be opened late: the names of reasons are set when PETSc starts, and its headers' counts of messages, which
// nobody reads, are counted here.
.macro variable name
  .globl \name
  .hidden \name
  .type \name, @object
  .size \name, 8
  .balign 8
\name:
  .quad 0
.endm
  .data
variable KSPConvergedReasons
variable couplet_petsc_is_lazy
variable petsc_allreduce_ct
variable petsc_gather_ct
variable petsc_recv_len
variable petsc_scatter_ct
variable petsc_send_len

  .section .note.GNU-stack, "", @progbits
