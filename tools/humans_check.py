def check(f):
    import os; print(os.path.getsize(f))
