use kalmanscope_lessons::{Lesson, LessonError, Question};

const GOOD: &str = "ask = \"a\"\nchoices = [\"x\", \"y\"]\nanswer = 2\nbecause = \"b\"\nuntil = 30.0";

fn question(text: &str) -> Result<Question, LessonError> {
    let head = "title = \"T\"\ncourse = \"Practice\"\nsummary = \"s\"\nscenario = \"stiffness-loss\"\n";
    let step = "[[steps]]\nlook = \"l\"\nhappens = \"h\"\nwhy = \"w\"\n";
    let mut lesson = Lesson::from_toml(&format!("{head}{step}[steps.question]\n{text}"))?;
    Ok(lesson.steps.remove(0).question.unwrap())
}

#[test]
fn the_answer_is_one_of_the_choices() {
    let question = question(GOOD).unwrap();
    assert_eq!(question.right_choice(), "y");
    assert_eq!([0, 1].map(|choice| question.is_right(choice)), [false, true]);
}

#[test]
fn errors_name_the_key_and_what_is_allowed() {
    for (part, other, message) in [
        ("ask = \"a\"", "ask = \" \"", "the question has an empty `ask`"),
        ("[\"x\", \"y\"]", "[\"x\", \"\"]", "the question has an empty choice"),
        ("[\"x\", \"y\"]", "[\"x\", \"x\"]", "the question has the same choice twice"),
        ("answer = 2", "answer = 3", "the question has the `answer` 3, but must have the number of a choice: 1 to 2"),
        ("because = \"b\"", "because = \"\"", "the question has an empty `because`"),
        ("until = 30.0", "until = 61.0", "the question has an `until` outside the record, which is from 0 to 60 s"),
    ] {
        assert_eq!(question(&GOOD.replace(part, other)).unwrap_err().to_string(), format!("step 1: {message}"));
    }
}
